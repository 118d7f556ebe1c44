"""Motion along a level circle at constant speed; the tray does not turn with it."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Literal

import numpy as np

from backend.config import Config, PositiveFloat
from backend.motions.belt import Heading, Point, level_pose, path_world, yaw_of
from backend.pose import Array, Pose


class CircularMotion(Config):
    """An arc around ``center_m``; the tray keeps facing the way it starts."""

    kind: Literal["circular"] = "circular"
    center_m: Point
    """Its height is that of the tray's top face, in the world."""
    radius_m: PositiveFloat
    start_angle_rad: float
    """Direction from the centre to the start, from the x axis, counter-clockwise."""
    direction: Literal[1, -1]
    """1 counter-clockwise, -1 clockwise, seen from above."""
    length_m: PositiveFloat
    """Length of the arc; it may go round more than once."""
    speed_mps: PositiveFloat

    @property
    def duration_s(self) -> float:
        return self.length_m / self.speed_mps

    @property
    def yaw_rad(self) -> float:
        """Heading of the tray, always that of the first velocity."""
        return yaw_of(self._ahead)

    @cached_property
    def _ahead(self) -> Heading:
        angle = self.start_angle_rad
        return -self.direction * math.sin(angle), self.direction * math.cos(angle)

    def pose_at(self, t_s: float) -> Pose:
        """T_world_tray at ``t_s``, which is clamped to [0, duration]."""
        return level_pose(self.xyz_at(t_s), self._ahead)

    def xyz_at(self, t_s: float) -> Point:
        """Where the tray is then."""
        angle = self._angle_rad(min(max(t_s, 0.0), self.duration_s))
        x, y, z = self.center_m
        return x + self.radius_m * math.cos(angle), y + self.radius_m * math.sin(angle), z

    def velocity_at(self, t_s: float) -> Array:
        """(3,) m/s of the tray; zero before the start and from the end on."""
        if not 0.0 <= t_s < self.duration_s:
            return np.zeros(3)
        angle = self._angle_rad(t_s)
        return self.direction * self.speed_mps * np.array([-math.sin(angle), math.cos(angle), 0.0])

    def path_world(self, n: int) -> Array:
        """(n, 3) points of the way, evenly spaced in time."""
        return path_world(self, n)

    def _angle_rad(self, t_s: float) -> float:
        return self.start_angle_rad + self.direction * self.speed_mps * t_s / self.radius_m
