"""Straight motion, level or slanted, at constant or evenly changing speed."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from backend.config import Config, PositiveFloat
from backend.motions.belt import Heading, Point, heading, level_pose, path_world, yaw_of
from backend.pose import Array, Pose


class LinearMotion(Config):
    """From ``start_m`` to ``end_m``, the speed changing evenly in time; the tray stays level."""

    kind: Literal["linear"] = "linear"
    start_m: Point
    """Middle of the tray's top face at time 0, in the world."""
    end_m: Point
    start_speed_mps: PositiveFloat
    """Along the line, also where it is slanted."""
    end_speed_mps: PositiveFloat

    @model_validator(mode="after")
    def _has_a_heading(self) -> Self:
        if math.dist(self.start_m[:2], self.end_m[:2]) < 1e-6:
            raise ValueError("start_m and end_m must differ in x or y")
        return self

    @cached_property
    def _ahead(self) -> Heading:
        return heading(self.start_m, self.end_m)

    @cached_property
    def length_m(self) -> float:
        return math.dist(self.start_m, self.end_m)

    @property
    def duration_s(self) -> float:
        return 2.0 * self.length_m / (self.start_speed_mps + self.end_speed_mps)

    @property
    def yaw_rad(self) -> float:
        """Heading of the motion, and of the tray."""
        return yaw_of(self._ahead)

    def pose_at(self, t_s: float) -> Pose:
        """T_world_tray at ``t_s``, which is clamped to [0, duration]."""
        return level_pose(self.xyz_at(t_s), self._ahead)

    def xyz_at(self, t_s: float) -> Point:
        """Where the tray is then."""
        t = min(max(t_s, 0.0), self.duration_s)
        acceleration = (self.end_speed_mps - self.start_speed_mps) / self.duration_s
        progress = (self.start_speed_mps + 0.5 * acceleration * t) * t / self.length_m
        (x0, y0, z0), (x1, y1, z1) = self.start_m, self.end_m
        return x0 + progress * (x1 - x0), y0 + progress * (y1 - y0), z0 + progress * (z1 - z0)

    def velocity_at(self, t_s: float) -> Array:
        """(3,) m/s of the tray; zero before the start and from the end on."""
        if not 0.0 <= t_s < self.duration_s:
            return np.zeros(3)
        gained = (self.end_speed_mps - self.start_speed_mps) * t_s / self.duration_s
        return (self.start_speed_mps + gained) * np.subtract(self.end_m, self.start_m) / self.length_m

    def path_world(self, n: int) -> Array:
        """(n, 3) points of the way, evenly spaced in time."""
        return path_world(self, n)
