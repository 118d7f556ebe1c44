"""Builds a grasp database: annealed candidates, raced against each other in noisy simulated lifts."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from backend import __version__
from backend.build.annealing import Annealer
from backend.build.digests import code_digest, rig_digest
from backend.build.racing import Counts, Heat, Noise, Racers, race
from backend.build.rig import RigSettings
from backend.build.sectors import SECTORS, count_by_sector, sectors
from backend.errors import InvalidInputError
from backend.files import cache_folder, replacing
from backend.knowledge.grasps import GraspDatabase
from backend.methods.method import Execution
from backend.objects import load_object
from backend.pose import Array
from backend.robots.models import load_model

OnProgress = Callable[[str], None]
SAVE_EVERY_S = 20.0
TELL_EVERY_S = 10.0
APART_M = 0.003
APART_RAD = float(np.radians(6.0))
"""Two grasps are distinct when shift / APART_M and turn / APART_RAD, as legs of a right angle, come to 1 or more."""
SECTOR_SHARE = 1 / 12
SECTOR_LAG = 0.15
"""Every sector's best go on, up to this share of the places, unless their rate lies that far behind the best."""

CODE = tuple(f"build/{name}.py" for name in ("annealing", "grasps", "hand_points", "object_field", "racing", "sectors"))
BRISK = RigSettings(
    execution=Execution(approach_s=0.5), close_at_most_s=0.5, lift_s=0.3, hold_s=0.15, solver_iterations=60
)
"""Run time's motions, done quicker: harder on a grasp, and cheaper to simulate."""


@dataclass(frozen=True)
class GraspSettings:
    """How much work goes into one database."""

    candidates: int = 5000
    """Distinct annealed grasps."""
    chains: int = 60_000
    """Annealing chains run at most for them."""
    rounds: tuple[tuple[int, int], ...] = ((5000, 1), (700, 3), (300, 8), (180, 20), (120, 50))
    """(how many of the best go on, lifts that each of them has had at the end) of every round."""
    rig: RigSettings = BRISK
    noise: Noise = field(default_factory=Noise)


@dataclass(frozen=True, eq=False)
class UnderWay:
    """How far a build has come: what is kept of it, so that it goes on the same after it was killed."""

    racers: Racers
    round: int
    """That is being run, from 1; one more than there are when all are done."""
    going_on: Counts
    """Who runs in it. Chosen when it begins: chosen anew amid a round, by half its lifts, it would be others."""

    @staticmethod
    def begin(racers: Racers, round: int, settings: GraspSettings) -> UnderWay:
        """A round that is about to begin; after the last one, one that nobody runs in."""
        keep = settings.rounds[round - 1][0] if round <= len(settings.rounds) else 0
        return UnderWay(racers, round, best(racers, keep))


def build_grasps(
    robot: str,
    object: str,
    seed: int,
    count: int,
    on_progress: OnProgress,
    settings: GraspSettings | None = None,
    workers: int = 1,
) -> GraspDatabase:
    """The ``count`` best grasps found (or fewer), best first. Same arguments, same database.

    What is done is kept in the user's cache: killed and begun again, it goes on. Raises ``NotFoundError`` for
    unknown names, ``InvalidInputError`` when no grasp lifts the object.
    """
    settings = settings or GraspSettings()
    begun_s = time.perf_counter()
    heat = Heat(robot, object, seed, settings.rig, settings.noise)
    path = checkpoint_file(heat, settings)
    under_way = _resumed(path)
    if under_way is None:
        under_way = UnderWay.begin(_entered(heat, settings, on_progress), 1, settings)
        _save(path, under_way)
    racers = under_way.racers
    while under_way.round <= len(settings.rounds):
        going_on, lifts = under_way.going_on, settings.rounds[under_way.round - 1][1]
        title = f"round {under_way.round} of {len(settings.rounds)}: "
        told_s = saved_s = time.perf_counter()
        for _ in race(heat, racers, going_on, lifts, workers):
            now_s = time.perf_counter()
            if now_s - told_s > TELL_EVERY_S:
                done = int((racers.lifts[going_on] >= lifts).sum())
                on_progress(f"{title}{done} of {len(going_on)} at {lifts} lifts")
                told_s = now_s
            if now_s - saved_s > SAVE_EVERY_S:
                _save(path, under_way)
                saved_s = now_s
        rate = racers.successes[going_on].sum() / racers.lifts[going_on].sum()
        on_progress(f"{title}{len(going_on)} grasps, {rate:.3f} of lifts hold")
        under_way = UnderWay.begin(racers, under_way.round + 1, settings)
        _save(path, under_way)
    if not racers.successes.any():
        raise InvalidInputError(f"{robot} cannot hold {object}: none of {len(racers.lifts)} grasps lifted it.")
    database = _database(heat, settings, racers, count, time.perf_counter() - begun_s)
    path.unlink(missing_ok=True)
    return database


def is_up_to_date(database: GraspDatabase, seed: int, count: int, settings: GraspSettings | None = None) -> bool:
    """Whether ``build_grasps`` would make this very database."""
    settings = settings or GraspSettings()
    heat = Heat(database.robot, database.object, seed, settings.rig, settings.noise)
    facts = database.facts
    return facts.get("source") == source_digest(heat, settings) and facts.get("wanted") == count


def best(racers: Racers, count: int) -> Counts:
    """The numbers of those that held oftenest; among equals the sectors take turns, each with its least slip first."""
    sector = sectors(racers.Ts_object_grasp)
    estimate, slip = racers.estimate, racers.mean_slip_m
    order = np.lexsort((np.arange(len(slip)), slip, -estimate))
    place = np.empty(len(order), np.int64)
    for k in range(len(SECTORS)):
        members = order[sector[order] == k]
        place[members] = np.arange(len(members))
    seeded = (place < count * SECTOR_SHARE) & (estimate >= estimate.max() - SECTOR_LAG)
    ranked = np.lexsort((np.arange(len(slip)), place, -estimate, ~seeded))[:count]
    return ranked[np.lexsort((place[ranked], -estimate[ranked]))]


def _entered(heat: Heat, settings: GraspSettings, on_progress: OnProgress) -> Racers:
    """Distinct candidates."""
    annealer = Annealer(load_model(heat.robot), load_object(heat.object), heat.seed)
    kept = np.zeros((0, 4, 4))
    chains, told_s = 0, time.perf_counter()
    for batch in annealer.batches():
        chains += batch.chains
        kept = np.concatenate([kept, distinct(batch.Ts_object_grasp, kept)])
        if time.perf_counter() - told_s > TELL_EVERY_S:
            on_progress(f"annealing: {len(kept)} distinct grasps from {chains} chains")
            told_s = time.perf_counter()
        if len(kept) >= settings.candidates or chains >= settings.chains:
            break
    kept = kept[: settings.candidates]
    on_progress(f"annealing done: {len(kept)} distinct grasps from {chains} chains, {count_by_sector(kept)}")
    return Racers.of(kept)


def distinct(Ts: Array, others: Array) -> Array:
    """Those of (n, 4, 4) that differ from all of ``others`` (m, 4, 4) and from each other."""
    kept: list[Array] = []
    known = _features(others)
    for T, feature in zip(Ts, _features(Ts), strict=True):
        if len(known) == 0 or np.square(known - feature).sum(axis=1).min() >= 1.0:
            kept.append(T)
            known = np.concatenate([known, feature[None]])
    return np.array(kept).reshape(-1, 4, 4)


def _features(Ts: Array) -> Array:
    """(n, 12) whose Euclidean distance is that of ``APART_M`` and ``APART_RAD``; a turn's chord stands for it."""
    turns = Ts[:, :3, :3].reshape(-1, 9) / (np.sqrt(2.0) * APART_RAD)
    return np.concatenate([Ts[:, :3, 3] / APART_M, turns], axis=1)


def _database(heat: Heat, settings: GraspSettings, racers: Racers, count: int, took_s: float) -> GraspDatabase:
    finalists = np.flatnonzero((racers.lifts == racers.lifts.max()) & (racers.successes > 0))
    chosen = finalists[best(racers.only(finalists), count)]
    held = racers.successes > 0
    return GraspDatabase(
        robot=heat.robot,
        object=heat.object,
        Ts_object_grasp=racers.Ts_object_grasp[chosen],
        lifts=racers.lifts[chosen],
        successes=racers.successes[chosen],
        facts={
            "seed": heat.seed,
            "source": source_digest(heat, settings),
            "wanted": count,
            "settings": _plain(settings),
            "versions": {"project": __version__, "pybullet": version("pybullet")},
            "candidates": len(racers.lifts),
            "candidates_that_lifted": int(held.sum()),
            "lifts": int(racers.lifts.sum()),
            "sectors_of_candidates": count_by_sector(racers.Ts_object_grasp),
            "sectors_that_lifted": count_by_sector(racers.Ts_object_grasp[held]),
            "sectors_kept": count_by_sector(racers.Ts_object_grasp[chosen]),
            "took_s": round(took_s, 1),
        },
    )


def checkpoint_file(heat: Heat, settings: GraspSettings) -> Path:
    """Where a build that is under way is kept."""
    return cache_folder() / "builds" / f"grasps-{heat.robot}-{heat.object}-{source_digest(heat, settings)}.npz"


def source_digest(heat: Heat, settings: GraspSettings) -> str:
    """Of everything that decides what a database holds, except how many of the best are kept."""
    digest = hashlib.sha256(json.dumps([_plain(heat), _plain(settings)]).encode())
    digest.update(rig_digest(heat.robot, heat.object).encode())
    digest.update(code_digest(CODE).encode())
    return digest.hexdigest()[:16]


def _plain(settings: Heat | GraspSettings) -> dict[str, Any]:
    """As JSON knows it."""
    text = json.dumps(asdict(settings), sort_keys=True, default=Execution.model_dump)
    plain: dict[str, Any] = json.loads(text)
    return plain


def _save(path: Path, under_way: UnderWay) -> None:
    with replacing(path) as file:
        np.savez(file, round=under_way.round, going_on=under_way.going_on, **under_way.racers.arrays())


def _resumed(path: Path) -> UnderWay | None:
    if not path.is_file():
        return None
    with np.load(path, allow_pickle=False) as arrays:
        loaded: dict[str, Any] = {name: arrays[name] for name in arrays.files}
    number, going_on = int(loaded.pop("round")), loaded.pop("going_on")
    return UnderWay(Racers(**loaded), number, going_on)
