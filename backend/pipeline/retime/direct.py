"""Direct: from any velocity to rest at a posture in the least time there is, every joint in its own way, all at once.

Each joint speeds up or brakes as hard as it may to a speed that it keeps, and brakes to rest. The slowest joint decides
how long it takes; the others choose the speed with which they arrive together with it.
"""

import numpy as np
from numpy.typing import NDArray

from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array
from backend.trajectory import Trajectory

Integers = NDArray[np.int64]

STEP_S = 1e-4
"""All changes of acceleration are at multiples of it, so that no piece of a motion is too short to reckon with."""
SHORTEST_STEPS = 10
SPARE_STEPS, MOST_SPARE_STEPS = 3, 48
"""Beyond the least time, so that rounding to steps takes no joint beyond its limits."""
HARDEST = 1.005
"""Of the acceleration limit, here."""


def least_s(q: Array, qd: Array, goals: Array, limits: JointLimits) -> Array:
    """(n,) least time from ``q`` (dof,) at ``qd`` (dof,) to rest at each of ``goals`` (n, dof)."""
    v, a = limits.velocity_rps, limits.acceleration_rps2
    way = goals - q
    sign = np.where(way >= 0.5 * qd * np.abs(qd) / a, 1.0, -1.0)
    way, rate = sign * way, sign * qd
    peak = np.sqrt(np.maximum(a * way + 0.5 * rate**2, 0.0))
    bang = (2.0 * peak - rate) / a
    cruise = (2.0 * v - rate) / a + (way - (v**2 - 0.5 * rate**2) / a) / v
    return np.where(peak <= v, bang, cruise).max(axis=1)


def direct(q: Array, qd: Array, goal: Array, limits: JointLimits) -> Trajectory:
    """From ``q`` (dof,) at ``qd`` (dof,) to rest at ``goal`` (dof,), beginning at time zero."""
    a, way = limits.acceleration_rps2, goal - q
    least = max(int(_steps(least_s(q, qd, goal[None], limits))[0]), SHORTEST_STEPS)
    spare, (kept, speeding, braking) = SPARE_STEPS, _in_steps(way, qd, a, least + SPARE_STEPS)
    while spare < MOST_SPARE_STEPS and not _within(limits, kept, qd, speeding, braking):
        spare *= 2
        kept, speeding, braking = _in_steps(way, qd, a, least + spare)
    steps = least + spare
    knots = np.unique(np.concatenate([[0, steps], speeding, steps - braking]))
    first = np.minimum(knots[:, None], speeding) / speeding
    last = np.maximum(knots[:, None] - (steps - braking), 0) / braking
    middle = np.clip(knots[:, None] - speeding, 0, steps - braking - speeding)
    ways = speeding * first * (qd + 0.5 * first * (kept - qd)) + kept * (middle + braking * last * (1.0 - 0.5 * last))
    qs, qds = q + STEP_S * ways, qd + first * (kept - qd) - last * kept
    qs[-1], qds[-1] = goal, 0.0
    return Trajectory(STEP_S * knots, qs, qds)


def _in_steps(way: Array, qd: Array, a: Array, steps: int) -> tuple[Array, Integers, Integers]:
    """(dof,) the speed that each joint keeps, and the steps in which it comes to it, and from it to rest."""
    kept = _speed_kept(way, qd, a, steps * STEP_S)
    braking = np.clip(_steps(np.abs(kept) / a) + 1, 1, steps - 1)
    speeding = np.clip(_steps(np.abs(kept - qd) / a) + 1, 1, steps - braking)
    return (way / STEP_S - 0.5 * speeding * qd) / (steps - 0.5 * (speeding + braking)), speeding, braking


def _within(limits: JointLimits, kept: Array, qd: Array, speeding: Integers, braking: Integers) -> bool:
    """Whether no joint speeds up or brakes harder than it may, nor keeps a speed beyond its limit."""
    changes = np.maximum(np.abs(kept - qd) / speeding, np.abs(kept) / braking)
    soft = changes <= HARDEST * STEP_S * limits.acceleration_rps2
    return bool((soft & (np.abs(kept) <= limits.velocity_rps)).all())


def _steps(duration_s: Array) -> Integers:
    """Steps that last at least so long, give or take a rounding."""
    return np.ceil(duration_s / STEP_S - 1e-6).astype(np.int64)


def _speed_kept(way: Array, rate: Array, a: Array, T: float) -> Array:
    """(dof,) the speed between speeding up and braking that makes ``way`` in ``T``.

    The way made grows with that speed, at as much as the time for which it is kept, so there is one.
    """
    between = (way - 0.5 * rate * np.abs(rate) / a) / np.maximum(T - np.abs(rate) / a, 1e-12)
    least, most = np.minimum(rate, 0.0), np.maximum(rate, 0.0)
    sign = np.where(between > most, 1.0, -1.0)
    half = 0.5 * (a * T + sign * rate)
    beyond = sign * (half - np.sqrt(np.maximum(half**2 - a * sign * way - 0.5 * rate**2, 0.0)))
    return np.where((least <= between) & (between <= most), between, beyond)
