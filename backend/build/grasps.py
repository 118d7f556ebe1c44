"""Builds a grasp database: antipodal candidates, raced against each other in noisy simulated lifts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from itertools import zip_longest

import numpy as np

from backend.build.antipodal import BANDS, AntipodalSampler
from backend.build.lift import Bench, LiftSettings
from backend.knowledge.grasps import GraspDatabase
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots.models import load_model

OnProgress = Callable[[str], None]
CLEARED_AT_ONCE = 48
FAIR_TURNS = 90
"""After so many draws a band that yields too little gives its share to the others."""


@dataclass(frozen=True)
class GraspSettings:
    """How much work goes into one database."""

    clean_lifts: int = 260
    """Candidates that are lifted once without noise."""
    rounds: tuple[tuple[int, int], ...] = ((180, 2), (140, 3), (110, 5))
    """(how many of the best go on, noisy lifts of each) of every further round."""
    draws: int = 12_000
    """Candidates drawn at most, clear or not."""
    lift: LiftSettings = field(default_factory=LiftSettings)


@dataclass(eq=False)
class _Racer:
    T_object_grasp: Array
    index: int
    lifts: int = 0
    successes: int = 0

    @property
    def estimate(self) -> float:
        """Success rate, drawn towards one half while lifts are few."""
        return (self.successes + 1.0) / (self.lifts + 2.0)


def build_grasps(
    robot: str,
    object: str,
    seed: int,
    count: int,
    on_progress: OnProgress,
    settings: GraspSettings | None = None,
) -> GraspDatabase:
    """The ``count`` best grasps found (or fewer), best first. Same arguments, same database."""
    settings = settings or GraspSettings()
    model, target = load_model(robot), load_object(object)
    bench = Bench(model, target, settings.lift)
    draw_rng, lift_rng = np.random.default_rng(seed).spawn(2)
    sampler = AntipodalSampler(model.description, target, draw_rng)
    racers = [_Racer(T, i) for i, T in enumerate(_clear_candidates(sampler, bench, settings))]
    on_progress(f"{len(racers)} grasps can be reached with the open hand")
    for racer in racers:
        _try(bench, racer, None)
    racers = [racer for racer in racers if racer.successes]
    on_progress(f"{len(racers)} lift without noise")
    for keep, lifts in settings.rounds:
        racers = _best(racers, keep)
        for racer in racers:
            for _ in range(lifts):
                _try(bench, racer, lift_rng.spawn(1)[0])
        rate = np.mean([r.successes / r.lifts for r in racers]) if racers else 0.0
        on_progress(f"{len(racers)} racing, {rate:.2f} of the lifts hold")
    return _database(robot, object, _best(racers, count), seed, settings)


def _clear_candidates(sampler: AntipodalSampler, bench: Bench, settings: GraspSettings) -> list[Array]:
    """Candidates, bands alternating, until there are enough or too many have been drawn."""
    found: list[list[Array]] = [[] for _ in BANDS]
    for turn in range(settings.draws // CLEARED_AT_ONCE):
        if sum(len(grasps) for grasps in found) >= settings.clean_lifts or not len(sampler):
            break
        band = turn % len(BANDS)
        drawn = [sampler.draw(BANDS[band]) for _ in range(CLEARED_AT_ONCE)]
        Ts = np.array([T for T in drawn if T is not None]).reshape(-1, 4, 4)
        clear = [T for T, ok in zip(Ts, bench.is_clear(Ts), strict=True) if ok]
        room = settings.clean_lifts // len(BANDS) - len(found[band])
        found[band] += clear[: max(room, 0)] if turn < FAIR_TURNS else clear
    in_turn = [T for row in zip_longest(*found) for T in row if T is not None]
    return in_turn[: settings.clean_lifts]


def _try(bench: Bench, racer: _Racer, rng: np.random.Generator | None) -> None:
    racer.successes += bench.lift(Pose(racer.T_object_grasp), rng)
    racer.lifts += 1


def _best(racers: list[_Racer], count: int) -> list[_Racer]:
    return sorted(racers, key=lambda racer: (-racer.estimate, racer.index))[:count]


def _database(
    robot: str, object: str, racers: list[_Racer], seed: int, settings: GraspSettings
) -> GraspDatabase:
    return GraspDatabase(
        robot=robot,
        object=object,
        Ts_object_grasp=np.array([racer.T_object_grasp for racer in racers]).reshape(-1, 4, 4),
        lifts=np.array([racer.lifts for racer in racers], dtype=np.int64),
        successes=np.array([racer.successes for racer in racers], dtype=np.int64),
        facts={"seed": seed, "settings": asdict(settings), "pybullet": version("pybullet")},
    )
