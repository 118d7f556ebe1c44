"""Chart of grasp poses: the five numbers that reachability depends on, and the way back.

A pose is turned about the base's z until its tcp lies at y = 0, which the first joint makes up for. What is left:
``rho_m`` and ``z_m`` of the tcp; ``u_rad, v_rad``, the approach direction as a rotation vector's bend away from
straight down (azimuthal equidistant: its length is the angle from straight down); ``roll_rad`` about the approach,
zero where the hand came there from (x, -y, -z) by the shortest rotation. Only straight up is singular.
"""

from __future__ import annotations

import numpy as np

from backend.kinematics.compiled import kernel
from backend.pose import Array

AXES = 5


@kernel
def fill_coordinates(row: Array, x: Array) -> float:
    """Fill ``x`` (5,): rho_m, z_m, u_rad, v_rad, roll_rad of a tcp row (12,); return its azimuth in radians."""
    rho = np.hypot(row[9], row[10])
    azimuth = np.arctan2(row[10], row[9])
    c, s = np.cos(azimuth), np.sin(azimuth)
    ax, ay, az = c * row[2] + s * row[5], c * row[5] - s * row[2], row[8]
    side = np.hypot(ax, ay)
    theta = np.arctan2(side, -az)
    bend = theta / side if side > 1e-12 else 1.0
    x[0], x[1], x[2], x[3] = rho, row[11], bend * ax, bend * ay
    k = max(1.0 - az, 1e-12)
    hx, hy, hz = c * row[0] + s * row[3], c * row[3] - s * row[0], row[6]
    along = hx * (1.0 - ax * ax / k) - hy * ax * ay / k + hz * ax
    across = hx * ax * ay / k - hy * (1.0 - ay * ay / k) - hz * ay
    x[4] = np.arctan2(across, along)
    return azimuth


@kernel
def fill_row(x: Array, row: Array) -> None:
    """Fill the tcp row (12,), at azimuth zero, of coordinates ``x`` (5,)."""
    theta = np.hypot(x[2], x[3])
    bend = np.sin(theta) / theta if theta > 1e-12 else 1.0
    ax, ay, az = bend * x[2], bend * x[3], -np.cos(theta)
    k = max(1.0 - az, 1e-12)
    c, s = np.cos(x[4]), np.sin(x[4])
    bx, by, bz = 1.0 - ax * ax / k, -ax * ay / k, ax
    dx, dy, dz = ax * ay / k, ay * ay / k - 1.0, -ay
    row[0], row[1], row[2] = c * bx + s * dx, c * dx - s * bx, ax
    row[3], row[4], row[5] = c * by + s * dy, c * dy - s * by, ay
    row[6], row[7], row[8] = c * bz + s * dz, c * dz - s * bz, az
    row[9], row[10], row[11] = x[0], 0.0, x[1]


@kernel
def fill_steps(u_rad: float, v_rad: float, steps: Array, metres_per_radian: float, out: Array) -> None:
    """Fill ``out`` (5,) with the length in metres of one grid step along every axis at an approach direction."""
    theta = np.hypot(u_rad, v_rad)
    squeeze = np.sin(theta) / theta if theta > 1e-9 else 1.0
    c, s = (u_rad / theta, v_rad / theta) if theta > 1e-9 else (1.0, 0.0)
    out[0], out[1] = steps[0], steps[1]
    out[2] = metres_per_radian * steps[2] * max(np.hypot(c, squeeze * s), 0.1)
    out[3] = metres_per_radian * steps[3] * max(np.hypot(s, squeeze * c), 0.1)
    out[4] = metres_per_radian * steps[4]
