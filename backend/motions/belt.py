"""What all motions share: they carry the belt's tray, whose frame is the middle of its top face."""

from typing import Protocol

import numpy as np

from backend.pose import Array, Pose

Point = tuple[float, float, float]
"""Metres in the world frame."""


class Moving(Protocol):
    """Anything that says where the tray is at any time."""

    @property
    def duration_s(self) -> float: ...

    def pose_at(self, t_s: float) -> Pose: ...


def path_world(motion: Moving, n: int) -> Array:
    """(n, 3) points of the tray's way, evenly spaced in time, ends included."""
    return np.array([motion.pose_at(t).xyz_m for t in np.linspace(0.0, motion.duration_s, n)])


def horizontal_yaw_rad(direction: Array) -> float:
    """Heading in (-pi, pi] of a direction (2,) or (3,) seen from above."""
    return float(np.arctan2(direction[1], direction[0]))
