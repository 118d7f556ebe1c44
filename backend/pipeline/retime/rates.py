"""Compiled: speeds along dense postures, and how far a motion is beyond its limits."""

import numpy as np

from backend.kinematics.compiled import kernel
from backend.pose import Array

SAME_S = 1e-9


@kernel
def speeds(qs: Array, t_s: Array, qd_start: Array) -> Array:
    """(n, dof) rad/s at postures (n, dof) passed at evenly spaced times (n,), beginning at ``qd_start`` (dof,).

    Central differences; at the end the last one.
    """
    n, dof = qs.shape
    out = np.empty((n, dof))
    out[0] = qd_start
    step_s = (t_s[n - 1] - t_s[0]) / (n - 1)
    for i in range(1, n - 1):
        for j in range(dof):
            out[i, j] = (qs[i + 1, j] - qs[i - 1, j]) / (2.0 * step_s)
    for j in range(dof):
        out[n - 1, j] = (qs[n - 1, j] - qs[n - 2, j]) / step_s
    return out


@kernel
def times_too_fast(
    t_s: Array, q: Array, qd: Array, velocity_rps: Array, acceleration_rps2: Array, from_s: float, until_s: float
) -> float:
    """The largest speed over its limit, or the root of the largest acceleration over its own.

    Of a cubic motion through ``q`` (n, dof) at ``qd`` (n, dof) and times (n,), exactly, over the pieces that begin in a
    span of time; see ``Trajectory.peaks``.
    """
    most = 0.0
    for i in range(t_s.shape[0] - 1):
        if t_s[i] < from_s - SAME_S or t_s[i] >= until_s - SAME_S:
            continue
        h = t_s[i + 1] - t_s[i]
        for j in range(q.shape[1]):
            v0, v1, rise = qd[i, j], qd[i + 1, j], (q[i + 1, j] - q[i, j]) / h
            a0, a1 = (6.0 * rise - 4.0 * v0 - 2.0 * v1) / h, (2.0 * v0 + 4.0 * v1 - 6.0 * rise) / h
            fastest = max(abs(v0), abs(v1))
            if a0 * a1 < 0.0:
                share = a0 / (a0 - a1)
                fastest = max(fastest, abs(v0 + h * share * (a0 + 0.5 * share * (a1 - a0))))
            hardest = max(abs(a0), abs(a1))
            most = max(most, fastest / velocity_rps[j], np.sqrt(hardest / acceleration_rps2[j]))
    return most
