"""From a built field to one worth shipping: zero calibrated, agreement with IK measured, all of it in its facts."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from backend.build import reach_measure as measure
from backend.build.digests import code_digest, files_digest
from backend.build.reach_oracle import Oracle
from backend.build.reachability import ReachabilitySettings, build_reachability
from backend.kinematics import Kinematics
from backend.knowledge.reachability import ReachabilityField
from backend.robots.models import load_model

OnProgress = Callable[[str], None]
Table = dict[str, Any]
CALIBRATION_POSES = 8_000
CODE = ("build/reach*.py", "kinematics/*.py", "knowledge/reach*.py")
PLAIN = ReachabilitySettings(
    position_step_m=measure.CELL_M,
    approach_step_rad=measure.CELL_RAD,
    rolls=10,
    postures=200_000,
    halvings=0,
)
"""The chart as coarse as the published grid, its borders half way between vertices."""


def calibrated(
    reach: ReachabilityField, kinematics: Kinematics, rng: np.random.Generator, on_progress: OnProgress
) -> ReachabilityField:
    """The same field with its zero moved until few unreachable poses of a set of its own are called reachable."""
    poses = measure.random_set(kinematics, workspace_m(reach), CALIBRATION_POSES, rng, on_progress)
    plain = replace(reach, shift_m=0.0)
    shift_m = measure.calibrated_shift(plain.signed_distance(poses.Ts), poses.reachable)
    facts = {**reach.facts, "calibration_poses": CALIBRATION_POSES}
    return replace(reach, shift_m=round(shift_m + 5e-5, 4), facts=facts)


def workspace_m(reach: ReachabilityField) -> float:
    """Radius around the base that poses are drawn from: all of the grid, whose last cells nothing reaches."""
    return float(reach.origin[0] + reach.steps[0] * (reach.levels.shape[0] - 2))


def report(
    reach: ReachabilityField,
    kinematics: Kinematics,
    seed: int,
    count: int,
    on_progress: OnProgress,
    *,
    compare: bool = True,
) -> Table:
    """Agreement with IK on ``count`` random poses and a tenth as many on belts, and what the value says beyond it.

    ``compare`` adds grids as coarse as the published one.
    """
    random_rng, belt_rng = np.random.default_rng(seed).spawn(2)
    poses = measure.random_set(kinematics, workspace_m(reach), count, random_rng, on_progress)
    on_progress("grasps on belts")
    belts, velocities = measure.belt_set(kinematics, max(count // 10, 100), belt_rng)
    half = count - count // 2
    sets = (
        measure.PoseSet("anywhere", poses.Ts[:half], poses.reachable[:half]),
        measure.PoseSet("within a cell of the border", poses.Ts[half:], poses.reachable[half:]),
        poses,
        belts,
    )
    fields = {"field": reach, "field, zero not shifted": replace(reach, shift_m=0.0)}
    if compare:
        on_progress("the chart at 10 cm / 36 deg")
        fields["chart at 10 cm / 36 deg"] = build_reachability(kinematics, seed, lambda _: None, settings=PLAIN)
    rows: list[Table] = []
    for some in sets:
        for name, one in fields.items():
            rows.append(_row(name, some, one.signed_distance(some.Ts) > 0.0))
        if compare:
            on_progress(f"plain 6-D grid, {some.name}")
            part = measure.PoseSet(some.name, some.Ts[::10], some.reachable[::10])
            rows.append(_row("6-D grid, 10 cm / 36 deg", part, measure.plain_grid_says(Oracle(kinematics), part.Ts)))
    on_progress("manipulability and lasting reachability")
    return {
        "robot": reach.robot,
        "agreement": rows,
        "manipulability_rank_correlation": measure.manipulability_correlation(reach, kinematics, belts, 500),
        "lasting_rank_correlation": measure.lasting_correlation(reach, kinematics, belts, velocities, 300),
        "query_ms_per_100": measure.query_ms(reach, poses.Ts),
        "shift_mm": 1e3 * reach.shift_m,
        "levels": list(reach.levels.shape),
    }


def finished(
    kinematics: Kinematics,
    seed: int,
    on_progress: OnProgress,
    workers: int = 1,
    settings: ReachabilitySettings | None = None,
    checked: int = 10_000,
) -> ReachabilityField:
    """Build, calibrate and check one field; chance for each comes from ``seed``. ``took_s`` leaves out the check."""
    begun_s = time.perf_counter()
    build_seed, calibration_seed, check_seed = (int(n) for n in np.random.SeedSequence(seed).generate_state(3))
    reach = build_reachability(kinematics, build_seed, on_progress, workers, settings)
    on_progress("calibrating against IK")
    reach = calibrated(reach, kinematics, np.random.default_rng(calibration_seed), on_progress)
    took_s = round(time.perf_counter() - begun_s, 1)
    table = report(reach, kinematics, check_seed, checked, on_progress, compare=False)
    source = source_digest(reach.robot, seed, settings)
    return replace(reach, facts={**reach.facts, "seed": seed, "source": source, "metrics": table, "took_s": took_s})


def is_up_to_date(reach: ReachabilityField, seed: int, settings: ReachabilitySettings | None = None) -> bool:
    """Whether ``finished`` would make this very field."""
    return reach.facts.get("source") == source_digest(reach.robot, seed, settings)


def source_digest(robot: str, seed: int, settings: ReachabilitySettings | None = None) -> str:
    """Of everything that decides a field: the robot's model, seed, settings, code."""
    folder = load_model(robot).hand_urdf.parent
    model = files_digest(sorted(path for path in folder.rglob("*") if path.is_file()))
    words = (model, seed, asdict(settings or ReachabilitySettings()), code_digest(CODE))
    return hashlib.sha256(repr(words).encode()).hexdigest()[:16]


def _row(name: str, poses: measure.PoseSet, says: measure.Bools) -> Table:
    return {"poses": poses.name, "by": name, **asdict(measure.agreement(says, poses.reachable))}
