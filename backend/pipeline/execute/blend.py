"""Quintic that takes a position and velocity to rest at zero: the shape of every approach and lift, on the rig too."""

import numpy as np

from backend.pose import Array

SHORTEST_LIFT_S = 1.0
COAST_S = 0.4
"""What horizontal speed the hand has dies away in so long."""


def to_zero(start: Array, velocity: Array, duration_s: float, t_s: Array) -> Array:
    """(n, k) values from ``start`` (k,) at ``velocity`` (k,) per second to zero at rest after ``duration_s``.

    Accelerations are zero at both ends; after ``duration_s`` the value stays zero.
    """
    T = duration_s
    u = np.clip(t_s / T, 0.0, 1.0)[:, None]
    rest = 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    moving = u * T * (1.0 - u**2 * (6.0 - 8.0 * u + 3.0 * u**2))
    return rest * start + moving * velocity


def lift_way(t_s: Array, velocity_mps: Array, duration_s: float, lift_m: float) -> Array:
    """(n, 3) where the hand has gone ``t_s`` (n,) after the lift began at ``velocity_mps`` (3,)."""
    coasted = velocity_mps * COAST_S / 2
    way = coasted + to_zero(-coasted, velocity_mps, COAST_S, t_s)
    way[:, 2] += lift_m + to_zero(np.array([-lift_m]), np.zeros(1), duration_s, t_s)[:, 0]
    return way


def rotations(rotvecs: Array) -> Array:
    """(n, 3, 3) rotations of (n, 3) rotation vectors (Rodrigues)."""
    angle = np.linalg.norm(rotvecs, axis=1)
    axis = rotvecs / np.where(angle > 1e-12, angle, 1.0)[:, None]
    K = np.zeros((len(rotvecs), 3, 3))
    K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
    K[:, 1, 0], K[:, 2, 0], K[:, 2, 1] = axis[:, 2], -axis[:, 1], axis[:, 0]
    return np.eye(3) + np.sin(angle)[:, None, None] * K + (1 - np.cos(angle))[:, None, None] * (K @ K)


def rotvec(rotation: Array) -> Array:
    """(3,) rotation vector of a (3, 3) rotation by less than pi."""
    skew = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = np.linalg.norm(skew)
    angle = np.arctan2(sine, np.trace(rotation) - 1.0)
    return skew * (angle / sine if sine > 1e-9 else 0.5)
