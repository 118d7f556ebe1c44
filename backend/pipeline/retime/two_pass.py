"""Time-optimal speed along a curve: one pass backwards, one forwards.

The reachability analysis of Pham and Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE T-RO 34(3), 2018, with each step's linear program solved in closed form.
Acceleration is held to its limit at both ends of every interval: on straight and parabolic pieces
that is everywhere.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
from backend.pose import Array

CUBIC_INTERVALS = 64
PARABOLA_INTERVALS = 32
STRAIGHT_SPACING_RAD = 0.04


@kernel
def bounds_of_u(slopes: Array, bends: Array, delta: float, limit: Array, x: float) -> tuple[float, float, float, float]:
    """Range of u = x' / 2 that keeps accelerations within ``limit`` at squared speed ``x``.

    ``slopes``, ``bends`` (2, dof): first and second derivative at the interval's ends. Returns low, high and
    their derivatives by x; low > high when ``x`` is too fast.
    """
    low, high, low_dx, high_dx = -np.inf, np.inf, 0.0, 0.0
    for j in range(limit.shape[0]):
        for end in range(2):
            c = bends[end, j]
            b = slopes[end, j] + (2.0 * delta * c if end == 1 else 0.0)
            for sign in (-1.0, 1.0):
                sc, sb = sign * c, sign * b
                room = limit[j] - sc * x
                if sb > 1e-12:
                    if room / sb < high:
                        high, high_dx = room / sb, -sc / sb
                elif sb < -1e-12:
                    if room / sb > low:
                        low, low_dx = room / sb, -sc / sb
                elif room < 0.0:
                    return np.inf, -np.inf, 0.0, 0.0
    return low, high, low_dx, high_dx


@kernel
def largest_x(slopes: Array, bends: Array, delta: float, limit: Array, cap: float, next_x: float) -> float:
    """Largest squared speed up to ``cap`` from which the next node's ``next_x`` need not be exceeded.

    Newton's method on a convex, piecewise linear excess: from above it never jumps over the root.
    """
    x = cap
    for _ in range(50):
        low, high, low_dx, high_dx = bounds_of_u(slopes, bends, delta, limit, x)
        if low == np.inf:
            x *= 0.5
            continue
        brake = (next_x - x) / (2.0 * delta)
        brake_dx = -0.5 / delta
        if brake < high:
            high, high_dx = brake, brake_dx
        excess = low - high
        if excess <= 1e-12:
            return x
        slope = low_dx - high_dx
        x = x - excess / slope if slope > 1e-12 else 0.5 * x
        if x <= 0.0:
            return 0.0
    return x


@kernel
def speeds(
    slopes: Array, bends: Array, deltas: Array, velocity: Array, acceleration: Array, start_x: float
) -> tuple[Array, bool]:
    """Squared speed (n + 1,) at the nodes between n intervals, ending at rest; False: started too fast.

    ``slopes``, ``bends`` (n, 2, dof): first and second derivative of the curve at both ends of intervals.
    """
    n, dof = deltas.shape[0], velocity.shape[0]
    reach, x = np.zeros(n + 1), np.zeros(n + 1)
    for i in range(n - 1, -1, -1):
        cap = 1e6
        for j in range(dof):
            fastest = abs(slopes[i, 0, j])
            if i > 0:
                fastest = max(fastest, abs(slopes[i - 1, 1, j]))
            if fastest > 1e-12:
                cap = min(cap, (velocity[j] / fastest) ** 2)
        if i == 0:
            cap = max(cap, start_x)
        reach[i] = largest_x(slopes[i], bends[i], deltas[i], acceleration, cap, reach[i + 1])
    if reach[0] < start_x * (1.0 - 1e-9):
        return x, False
    x[0] = start_x
    for i in range(n):
        low, high, _, _ = bounds_of_u(slopes[i], bends[i], deltas[i], acceleration, x[i])
        x[i + 1] = max(0.0, min(reach[i + 1], x[i] + 2.0 * deltas[i] * max(low, high)))
    return x, True


@kernel
def count_intervals(coefficients: Array, lengths: Array) -> NDArray[np.int64]:
    """(n,) intervals that each piece is divided into."""
    out = np.empty(lengths.shape[0], dtype=np.int64)
    for k in range(lengths.shape[0]):
        if np.max(np.abs(coefficients[k, 3])) > 0.0:
            out[k] = CUBIC_INTERVALS
        elif np.max(np.abs(coefficients[k, 2])) > 0.0:
            out[k] = PARABOLA_INTERVALS
        else:
            out[k] = min(48, max(8, int(np.ceil(lengths[k] / STRAIGHT_SPACING_RAD))))
    return out


@kernel
def grid(coefficients: Array, lengths: Array) -> tuple[NDArray[np.int64], Array]:
    """(n,) piece, and (n, 2) its parameter at both ends, of every interval.

    Straight pieces have nodes crowded at their ends, where the arm accelerates and brakes.
    """
    counts = count_intervals(coefficients, lengths)
    piece, u = np.empty(np.sum(counts), dtype=np.int64), np.empty((np.sum(counts), 2))
    i = 0
    for k in range(lengths.shape[0]):
        for j in range(counts[k]):
            piece[i] = k
            for end in range(2):
                share = (j + end) / counts[k]
                if np.max(np.abs(coefficients[k, 2:])) == 0.0:
                    share = 0.5 - 0.5 * np.cos(np.pi * share)
                u[i, end] = share * lengths[k]
            i += 1
    return piece, u


@kernel
def derivatives(coefficients: Array, piece: NDArray[np.int64], u: Array) -> tuple[Array, Array, Array]:
    """Position, first and second derivative (n, 2, dof) at both ends of every interval."""
    n, dof = piece.shape[0], coefficients.shape[2]
    q, slopes, bends = np.empty((n, 2, dof)), np.empty((n, 2, dof)), np.empty((n, 2, dof))
    for i in range(n):
        c = coefficients[piece[i]]
        for end in range(2):
            v = u[i, end]
            for j in range(dof):
                q[i, end, j] = c[0, j] + v * (c[1, j] + v * (c[2, j] + v * c[3, j]))
                slopes[i, end, j] = c[1, j] + v * (2.0 * c[2, j] + 3.0 * v * c[3, j])
                bends[i, end, j] = 2.0 * c[2, j] + 6.0 * v * c[3, j]
    return q, slopes, bends


@kernel
def two_pass(
    coefficients: Array, lengths: Array, velocity: Array, acceleration: Array, start_speed: float
) -> tuple[Array, bool]:
    """Speed (n + 1,) along the curve at the nodes of its grid, and whether the start can be kept."""
    piece, u = grid(coefficients, lengths)
    _, slopes, bends = derivatives(coefficients, piece, u)
    x, feasible = speeds(slopes, bends, u[:, 1] - u[:, 0], velocity, acceleration, start_speed**2)
    return np.sqrt(x), feasible


@kernel
def timed(coefficients: Array, lengths: Array, speed: Array) -> tuple[Array, Array, Array]:
    """Times (n + 1,) from zero, positions and velocities (n + 1, dof) at the nodes of the curve's grid."""
    piece, u = grid(coefficients, lengths)
    q, slopes, _ = derivatives(coefficients, piece, u)
    n, dof = piece.shape[0], coefficients.shape[2]
    t_s, out, velocity = np.zeros(n + 1), np.empty((n + 1, dof)), np.empty((n + 1, dof))
    out[0], velocity[0] = q[0, 0], slopes[0, 0] * speed[0]
    for i in range(n):
        t_s[i + 1] = t_s[i] + 2.0 * (u[i, 1] - u[i, 0]) / (speed[i] + speed[i + 1])
        out[i + 1], velocity[i + 1] = q[i, 1], slopes[i, 1] * speed[i + 1]
    return t_s, out, velocity
