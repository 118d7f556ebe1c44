"""Straight motion, level or slanted, at constant or evenly changing speed."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from backend.config import Config, PositiveFloat
from backend.motions.belt import Point, horizontal_yaw_rad, path_world
from backend.pose import Array, Pose


class LinearMotion(Config):
    """From ``start_m`` to ``end_m``, the speed changing evenly in time; the tray stays level."""

    kind: Literal["linear"] = "linear"
    start_m: Point
    """Middle of the tray's top face at time 0, in the world."""
    end_m: Point
    start_speed_mps: PositiveFloat
    """Along the line, also where it is slanted."""
    end_speed_mps: Annotated[float, Field(gt=0.0)]

    @model_validator(mode="after")
    def _has_a_heading(self) -> Self:
        if np.hypot(*self._span[:2]) < 1e-6:
            raise ValueError("start_m and end_m must differ in x or y")
        return self

    @property
    def _span(self) -> Array:
        return np.subtract(self.end_m, self.start_m)

    @property
    def length_m(self) -> float:
        return float(np.linalg.norm(self._span))

    @property
    def duration_s(self) -> float:
        return 2.0 * self.length_m / (self.start_speed_mps + self.end_speed_mps)

    @property
    def yaw_rad(self) -> float:
        """Heading of the motion, and of the tray."""
        return horizontal_yaw_rad(self._span)

    def pose_at(self, t_s: float) -> Pose:
        """T_world_tray at ``t_s``, which is clamped to [0, duration]."""
        t = min(max(t_s, 0.0), self.duration_s)
        acceleration = (self.end_speed_mps - self.start_speed_mps) / self.duration_s
        progress = (self.start_speed_mps + 0.5 * acceleration * t) * t / self.length_m
        return Pose.from_xyz_yaw(self.start_m + progress * self._span, self.yaw_rad)

    def velocity_at(self, t_s: float) -> Array:
        """(3,) m/s of the tray; zero before the start and from the end on."""
        if not 0.0 <= t_s < self.duration_s:
            return np.zeros(3)
        gained = (self.end_speed_mps - self.start_speed_mps) * t_s / self.duration_s
        return (self.start_speed_mps + gained) * self._span / self.length_m

    def path_world(self, n: int) -> Array:
        """(n, 3) points of the way, evenly spaced in time."""
        return path_world(self, n)
