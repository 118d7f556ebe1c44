"""Direct: from any velocity to rest at a posture in the least time there is, every joint in its own way, all at once.

Each joint speeds up or brakes as hard as it may to a speed that it keeps, and brakes to rest. The slowest joint decides
how long it takes; the others choose the speed with which they arrive together with it.
"""

import numpy as np

from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array
from backend.trajectory import Trajectory

SHORTEST_S = 1e-3
SAME_KNOT_S = 1e-6


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
    T = max(float(least_s(q, qd, goal[None], limits)[0]), SHORTEST_S)
    a = limits.acceleration_rps2
    kept = _speed_kept(goal - q, qd, a, T)
    reached_s = np.minimum(np.abs(kept - qd) / a, T)
    leave_s = np.maximum(T - np.abs(kept) / a, reached_s)
    knots = np.unique(np.concatenate([[0.0, T], reached_s, leave_s]))
    t = knots[np.concatenate([[True], np.diff(knots) > SAME_KNOT_S])]
    t[-1] = T
    first, last = np.minimum(t[:, None], reached_s), np.maximum(t[:, None] - leave_s, 0.0)
    middle = np.clip(t[:, None] - reached_s, 0.0, leave_s - reached_s)
    up, down = a * np.sign(kept - qd), -a * np.sign(kept)
    qs = q + first * (qd + 0.5 * up * first) + kept * (middle + last) + 0.5 * down * last**2
    qds = qd + up * first + down * last
    qs[-1], qds[-1] = goal, 0.0
    return Trajectory(t, qs, qds)


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
