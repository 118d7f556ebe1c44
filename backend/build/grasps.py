"""Builds a grasp database: antipodal candidates, raced against each other in noisy simulated lifts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from importlib.metadata import version

import numpy as np

from backend.build.antipodal import BANDS, AntipodalSampler
from backend.build.lift import Bench, LiftSettings
from backend.errors import InvalidInputError
from backend.knowledge.grasps import GraspDatabase
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots.models import load_model

OnProgress = Callable[[str], None]
DRAWN_AT_ONCE = 48
TAKEN_AT_ONCE = 6


@dataclass(frozen=True)
class GraspSettings:
    """How much work goes into one database."""

    clean_lifts: int = 400
    """Candidates lifted once without noise, at most."""
    clean_wanted: int = 120
    """How many of them must hold before the race begins."""
    rounds: tuple[tuple[int, int], ...] = ((115, 2), (100, 3))
    """(how many of the best go on, noisy lifts of each) of every further round."""
    draws: int = 20_000
    """Candidates drawn at most, clear or not."""
    lift: LiftSettings = field(default_factory=LiftSettings)


@dataclass(eq=False)
class _Racer:
    T_object_grasp: Array
    lifts: int = 0
    successes: int = 0
    slip_m: float = 0.0
    """Summed over the lifts that held."""

    @property
    def estimate(self) -> float:
        """Success rate, drawn towards one half while lifts are few."""
        return (self.successes + 1.0) / (self.lifts + 2.0)

    @property
    def mean_slip_m(self) -> float:
        return self.slip_m / max(self.successes, 1)

    @property
    def band(self) -> str:
        return next(band.name for band in BANDS if band.holds(self.T_object_grasp[:3, 2]))


def build_grasps(
    robot: str,
    object: str,
    seed: int,
    count: int,
    on_progress: OnProgress,
    settings: GraspSettings | None = None,
) -> GraspDatabase:
    """The ``count`` best grasps found (or fewer), best first. Same arguments, same database.

    Raises ``NotFoundError`` for unknown names, ``InvalidInputError`` when no grasp lifts the object.
    """
    settings = settings or GraspSettings()
    model, target = load_model(robot), load_object(object)
    bench = Bench(model, target, settings.lift)
    draw_rng, lift_rng = np.random.default_rng(seed).spawn(2)
    sampler = AntipodalSampler(model.description, target, draw_rng)
    racers: list[_Racer] = []
    tried = 0
    for T_object_grasp in _clear_candidates(sampler, bench, settings.draws):
        racer = _Racer(T_object_grasp)
        _try(bench, racer, None)
        tried += 1
        racers += [racer] * racer.successes
        if len(racers) >= settings.clean_wanted or tried >= settings.clean_lifts:
            break
    on_progress(f"{len(racers)} of {tried} lift without noise")
    if not racers:
        raise InvalidInputError(f"{robot} cannot hold {object}: none of {tried} grasps lifted it.")
    for keep, lifts in settings.rounds:
        racers = _best(racers, keep)
        for racer in racers:
            for _ in range(lifts):
                _try(bench, racer, lift_rng.spawn(1)[0])
        rate = np.mean([r.successes / r.lifts for r in racers])
        on_progress(f"{len(racers)} racing, {rate:.2f} of the lifts hold")
    return _database(robot, object, _best(racers, count), seed, settings)


def _clear_candidates(sampler: AntipodalSampler, bench: Bench, draws: int) -> Iterator[Array]:
    """Grasps (4, 4) that the open hand can reach, a few of each band in turn, until ``draws`` have been drawn."""
    for turn in range(draws // DRAWN_AT_ONCE if len(sampler) else 0):
        band = BANDS[turn % len(BANDS)]
        drawn = [sampler.draw(band) for _ in range(DRAWN_AT_ONCE)]
        Ts = np.array([T for T in drawn if T is not None]).reshape(-1, 4, 4)
        clear = [T for T, ok in zip(Ts, bench.is_clear(Ts), strict=True) if ok]
        yield from clear[:TAKEN_AT_ONCE]


def _try(bench: Bench, racer: _Racer, rng: np.random.Generator | None) -> None:
    lifted = bench.lift(Pose(racer.T_object_grasp), rng)
    racer.lifts += 1
    if lifted.held:
        racer.successes += 1
        racer.slip_m += lifted.slip_m


def _best(racers: list[_Racer], count: int) -> list[_Racer]:
    """Those that held oftenest; among equals the bands take turns, each with its least slip first."""
    place: dict[str, int] = {}
    ordered: list[tuple[float, int, _Racer]] = []
    for racer in sorted(racers, key=lambda racer: (-racer.estimate, racer.mean_slip_m)):
        place[racer.band] = place.get(racer.band, -1) + 1
        ordered.append((-racer.estimate, place[racer.band], racer))
    return [racer for *_, racer in sorted(ordered, key=lambda entry: entry[:2])][:count]


def _database(robot: str, object: str, racers: list[_Racer], seed: int, settings: GraspSettings) -> GraspDatabase:
    return GraspDatabase(
        robot=robot,
        object=object,
        Ts_object_grasp=np.array([racer.T_object_grasp for racer in racers]).reshape(-1, 4, 4),
        lifts=np.array([racer.lifts for racer in racers], dtype=np.int64),
        successes=np.array([racer.successes for racer in racers], dtype=np.int64),
        facts={"seed": seed, "settings": asdict(settings), "pybullet": version("pybullet")},
    )
