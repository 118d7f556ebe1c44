"""Direct: from any velocity to rest at a posture in the least time there is, every joint in its own way, all at once.

Each joint speeds up or brakes as hard as it may to a speed that it keeps, and brakes to rest. The slowest joint decides
how long it takes; the others choose the speed with which they arrive together with it.
"""

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
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
    return _least_s_each(q, qd, goals, limits.velocity_rps, limits.acceleration_rps2)


def direct(q: Array, qd: Array, goal: Array, limits: JointLimits) -> Trajectory:
    """From ``q`` (dof,) at ``qd`` (dof,) to rest at ``goal`` (dof,), beginning at time zero."""
    return Trajectory(*_motion(q, qd, goal, limits.velocity_rps, limits.acceleration_rps2))


@kernel
def _least_s_each(q: Array, qd: Array, goals: Array, v: Array, a: Array) -> Array:
    out = np.zeros(goals.shape[0])
    for i in range(goals.shape[0]):
        for j in range(q.shape[0]):
            out[i] = max(out[i], _least_s(goals[i, j] - q[j], qd[j], v[j], a[j]))
    return out


@kernel
def _least_s(way: float, rate: float, v: float, a: float) -> float:
    """Least time in which one joint that moves at ``rate`` makes ``way`` and comes to rest."""
    if way < 0.5 * rate * abs(rate) / a:
        way, rate = -way, -rate
    peak = np.sqrt(max(a * way + 0.5 * rate**2, 0.0))
    if peak <= v:
        return (2.0 * peak - rate) / a
    return (2.0 * v - rate) / a + (way - (v**2 - 0.5 * rate**2) / a) / v


@kernel
def _motion(q: Array, qd: Array, goal: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
    """Times (n,), postures (n, dof) and velocities (n, dof) of ``direct``."""
    dof = q.shape[0]
    kept, speeding, braking = np.empty(dof), np.empty(dof, dtype=np.int64), np.empty(dof, dtype=np.int64)
    least = max(_steps(_least_s_each(q, qd, goal.reshape(1, dof), v, a)[0]), SHORTEST_STEPS)
    spare = SPARE_STEPS
    while not _in_steps(goal - q, qd, v, a, least + spare, kept, speeding, braking) and spare < MOST_SPARE_STEPS:
        spare *= 2
    steps = least + spare
    knots = np.unique(np.concatenate((np.array([0, steps]), speeding, steps - braking)))
    qs, qds = np.empty((len(knots), dof)), np.empty((len(knots), dof))
    for i in range(len(knots)):
        for j in range(dof):
            first = min(knots[i], speeding[j]) / speeding[j]
            last = max(knots[i] - (steps - braking[j]), 0) / braking[j]
            middle = min(max(knots[i] - speeding[j], 0), steps - braking[j] - speeding[j])
            speeding_up = speeding[j] * first * (qd[j] + 0.5 * first * (kept[j] - qd[j]))
            way = speeding_up + kept[j] * (middle + braking[j] * last * (1.0 - 0.5 * last))
            qs[i, j], qds[i, j] = q[j] + STEP_S * way, qd[j] + first * (kept[j] - qd[j]) - last * kept[j]
    qs[-1], qds[-1] = goal, 0.0
    t_s = knots * np.float64(STEP_S)
    return t_s, qs, qds


@kernel
def _in_steps(
    way: Array, qd: Array, v: Array, a: Array, steps: int, kept: Array, speeding: Integers, braking: Integers
) -> bool:
    """Fill in (dof,) the speed that each joint keeps, and the steps in which it comes to it, and from it to rest.

    False when a joint speeds up or brakes harder than it may, or keeps a speed beyond its limit.
    """
    within = True
    for j in range(way.shape[0]):
        speed = _speed_kept(way[j], qd[j], a[j], steps * STEP_S)
        braking[j] = min(max(_steps(abs(speed) / a[j]) + 1, 1), steps - 1)
        speeding[j] = min(max(_steps(abs(speed - qd[j]) / a[j]) + 1, 1), steps - braking[j])
        rest = steps - 0.5 * (speeding[j] + braking[j])
        kept[j] = (way[j] / STEP_S - 0.5 * speeding[j] * qd[j]) / rest
        change = max(abs(kept[j] - qd[j]) / speeding[j], abs(kept[j]) / braking[j])
        within = within and change <= HARDEST * STEP_S * a[j] and abs(kept[j]) <= v[j]
    return within


@kernel
def _steps(duration_s: float) -> int:
    """Steps that last at least so long, give or take a rounding."""
    return int(np.ceil(duration_s / STEP_S - 1e-6))


@kernel
def _speed_kept(way: float, rate: float, a: float, T: float) -> float:
    """The speed between speeding up and braking that makes ``way`` in ``T``.

    The way made grows with that speed, at as much as the time for which it is kept, so there is one.
    """
    between = (way - 0.5 * rate * abs(rate) / a) / max(T - abs(rate) / a, 1e-12)
    least, most = min(rate, 0.0), max(rate, 0.0)
    if least <= between <= most:
        return between
    sign = 1.0 if between > most else -1.0
    half = 0.5 * (a * T + sign * rate)
    return sign * (half - np.sqrt(max(half**2 - a * sign * way - 0.5 * rate**2, 0.0)))
