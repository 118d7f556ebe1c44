"""What all motions share: they carry the belt's tray, whose frame is the middle of its top face."""

import math
from typing import Protocol

import numpy as np

from backend.pose import Array, Pose

Point = tuple[float, float, float]
"""Metres in the world frame."""

Heading = tuple[float, float]
"""Level unit vector in the world frame."""


class Moving(Protocol):
    """Anything that says where the tray is at any time."""

    @property
    def duration_s(self) -> float: ...

    def pose_at(self, t_s: float) -> Pose: ...


def path_world(motion: Moving, n: int) -> Array:
    """(n, 3) points of the tray's way, evenly spaced in time, ends included."""
    return np.array([motion.pose_at(t).xyz_m for t in np.linspace(0.0, motion.duration_s, n)])


def level_pose(xyz_m: Point, ahead: Heading) -> Pose:
    """T_world_tray of a level tray whose x axis points ``ahead``."""
    (x, y, z), (ax, ay) = xyz_m, ahead
    return Pose(np.array([[ax, -ay, 0.0, x], [ay, ax, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]))


def heading(start_m: Point, end_m: Point) -> Heading:
    """Heading of the way from one point to another; they must differ in x or y."""
    dx, dy = end_m[0] - start_m[0], end_m[1] - start_m[1]
    level_m = math.hypot(dx, dy)
    return dx / level_m, dy / level_m


def yaw_of(ahead: Heading) -> float:
    """Angle in (-pi, pi] from the x axis."""
    return math.atan2(ahead[1], ahead[0])
