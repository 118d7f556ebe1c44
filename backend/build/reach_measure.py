"""How good a reachability field is: agreement with IK, and what its value says beyond the sign."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from backend.build.reach_oracle import CELL_M, CELL_RAD, Bools, Oracle, belt_poses, border_poses, random_poses
from backend.kinematics import Kinematics
from backend.knowledge.reachability import ReachabilityField
from backend.pose import Array, rotation_from_rpy

OnProgress = Callable[[str], None]
HEIGHT_MAX_M = 0.9
STEEPEST_RAD = float(np.radians(115.0))
"""Poses asked about: tcp up to this height, approaches up to this angle from straight down."""
LASTING_STEP_S, LASTING_MAX_S = 0.5, 10.0
FALSE_POSITIVES_WANTED = 0.007
"""Of the unreachable poses of the calibration set; a bit below the goal of 1 %, for that set is small."""


@dataclass(frozen=True, eq=False)
class PoseSet:
    """Poses and what the oracle says of them."""

    name: str
    Ts: Array
    """(n, 4, 4)."""
    reachable: Bools


@dataclass(frozen=True)
class Agreement:
    """Of signs, on one set of poses."""

    poses_asked: int
    reachable: float
    """Share of the poses that the oracle reaches."""
    accuracy: float
    false_positives: float
    """Share of all poses that are called reachable and are not."""
    false_positive_rate: float
    """The same, as a share of the unreachable ones."""
    false_negatives: float
    """Share of all poses that are called unreachable and are not."""


def agreement(called_reachable: Bools, truth: Bools) -> Agreement:
    """Compare signs with the oracle's answers."""
    wrong_yes, wrong_no = called_reachable & ~truth, ~called_reachable & truth
    return Agreement(
        poses_asked=len(truth),
        reachable=float(truth.mean()),
        accuracy=float((called_reachable == truth).mean()),
        false_positives=float(wrong_yes.mean()),
        false_positive_rate=float(wrong_yes.sum() / max((~truth).sum(), 1)),
        false_negatives=float(wrong_no.mean()),
    )


def random_set(
    kinematics: Kinematics, reach_m: float, count: int, rng: np.random.Generator, on_progress: OnProgress
) -> PoseSet:
    """Half anywhere around the workspace, half within a cell of the border; in that order."""
    oracle = Oracle(kinematics)
    domain = (reach_m, HEIGHT_MAX_M, STEEPEST_RAD)
    anywhere = random_poses(rng, count - count // 2, *domain)
    known = oracle.reachable(anywhere)
    near, known_near = border_poses(rng, oracle, count // 2, domain, on_progress)
    return PoseSet(
        "random, half near the border", np.concatenate([anywhere, near]), np.concatenate([known, known_near])
    )


def belt_set(kinematics: Kinematics, count: int, rng: np.random.Generator) -> tuple[PoseSet, Array]:
    """Grasps and pregrasps of the databases on the tasks' belts, and (count, 3) how fast their objects go."""
    Ts, velocities = belt_poses(rng, kinematics, count)
    return PoseSet("grasps on belts", Ts, Oracle(kinematics).reachable(Ts)), velocities


def calibrated_shift(distances: Array, truth: Bools, wanted: float = FALSE_POSITIVES_WANTED) -> float:
    """The smallest shift, not below zero, that leaves at most ``wanted`` of the unreachable poses above zero."""
    wrong = np.sort(distances[~truth])[::-1]
    allowed = int(wanted * len(wrong))
    return max(0.0, float(wrong[allowed])) if allowed < len(wrong) else 0.0


def plain_grid_says(oracle: Oracle, Ts: Array) -> Bools:
    """(n,) what a plain 6-D grid of 10 cm and 36 degrees in x, y, z, roll, pitch, yaw holds at the nearest vertex."""
    snapped = Ts.copy()
    snapped[:, :3, 3] = np.rint(Ts[:, :3, 3] / CELL_M) * CELL_M
    for i, T in enumerate(Ts):
        rpy = np.array([np.arctan2(T[2, 1], T[2, 2]), np.arcsin(-T[2, 0]), np.arctan2(T[1, 0], T[0, 0])])
        snapped[i, :3, :3] = rotation_from_rpy(np.rint(rpy / CELL_RAD) * CELL_RAD)
    return oracle.reachable(snapped)


def manipulability_correlation(field: ReachabilityField, kinematics: Kinematics, poses: PoseSet, count: int) -> float:
    """Spearman's rank correlation of the arm's own distance with sqrt(det(J J^T)) of the best free branch.

    Manipulability after Yoshikawa (1985).
    """
    oracle, Ts = Oracle(kinematics), poses.Ts[poses.reachable][:count]
    best: list[float] = []
    for T in Ts:
        jacobians = [kinematics.jacobian(q) for q in oracle.free_postures(T)]
        best.append(max((float(np.sqrt(abs(np.linalg.det(J @ J.T)))) for J in jacobians), default=0.0))
    return _rank_correlation(field.parts(Ts)[:, 0], np.array(best))


def lasting_correlation(
    field: ReachabilityField, kinematics: Kinematics, poses: PoseSet, velocities: Array, count: int
) -> float:
    """The same with how long, up to 10 s, a grasp stays reachable as its object goes straight on."""
    oracle = Oracle(kinematics)
    Ts, speeds = poses.Ts[poses.reachable][:count], velocities[poses.reachable][:count]
    lasting_s = np.zeros(len(Ts))
    still = np.ones(len(Ts), dtype=np.bool_)
    for t_s in np.arange(LASTING_STEP_S, LASTING_MAX_S + 1e-9, LASTING_STEP_S):
        moved = Ts[still].copy()
        moved[:, :3, 3] += speeds[still] * t_s
        alive = np.flatnonzero(still)
        still[alive] = oracle.reachable(moved)
        lasting_s[still] = t_s
    return _rank_correlation(field.parts(Ts)[:, 0], lasting_s)


def _rank_correlation(a: Array, b: Array) -> float:
    """Spearman's."""
    return float(np.corrcoef(stats.rankdata(a), stats.rankdata(b))[0, 1])


def query_ms(field: ReachabilityField, Ts: Array, batch: int = 100, repeats: int = 200) -> float:
    """Median wall time of one call with ``batch`` poses, other ones each time."""
    batches = [Ts[np.arange(i * batch, (i + 1) * batch) % len(Ts)] for i in range(repeats)]
    field.signed_distance(batches[0])
    took: list[float] = []
    for some in batches:
        begun_s = time.perf_counter()
        field.signed_distance(some)
        took.append(time.perf_counter() - begun_s)
    return 1e3 * float(np.median(took))
