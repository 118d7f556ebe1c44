"""A sinusoid superimposed on level straight motion; the tray does not turn with it."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from backend.config import Config, NonNegativeFloat, PositiveFloat
from backend.motions.belt import Heading, Point, heading, level_pose, path_world, yaw_of
from backend.pose import Array, Pose


class SinusoidalMotion(Config):
    """Progress along the axis at ``speed_mps`` while the tray swings to its left and right.

    The true speed is larger: with the paper's amplitude l/8 and period l/3 it runs from 1.0 times
    ``speed_mps`` at the crests to 2.6 times where the axis is crossed.
    """

    kind: Literal["sinusoidal"] = "sinusoidal"
    start_m: Point
    """Middle of the tray's top face at time 0, in the world."""
    end_m: Point
    """At the same height as the start."""
    speed_mps: PositiveFloat
    """Of the progress along the axis from ``start_m`` to ``end_m``."""
    amplitude_m: NonNegativeFloat
    """First to the left of the axis."""
    period_m: PositiveFloat
    """Progress along the axis per swing."""

    @model_validator(mode="after")
    def _is_level(self) -> Self:
        if math.dist(self.start_m[:2], self.end_m[:2]) < 1e-6 or self.start_m[2] != self.end_m[2]:
            raise ValueError("start_m and end_m must differ in x or y, and not in z")
        return self

    @cached_property
    def length_m(self) -> float:
        """Of the axis."""
        return math.dist(self.start_m, self.end_m)

    @property
    def duration_s(self) -> float:
        return self.length_m / self.speed_mps

    @property
    def yaw_rad(self) -> float:
        """Heading of the axis, and of the tray."""
        return yaw_of(self._ahead)

    def pose_at(self, t_s: float) -> Pose:
        """T_world_tray at ``t_s``, which is clamped to [0, duration]."""
        return level_pose(self.xyz_at(t_s), self._ahead)

    def xyz_at(self, t_s: float) -> Point:
        """Where the tray is then."""
        progress_m = self.speed_mps * min(max(t_s, 0.0), self.duration_s)
        swing_m = self.amplitude_m * math.sin(2.0 * math.pi * progress_m / self.period_m)
        (x, y, z), (ax, ay) = self.start_m, self._ahead
        return x + progress_m * ax - swing_m * ay, y + progress_m * ay + swing_m * ax, z

    def velocity_at(self, t_s: float) -> Array:
        """(3,) m/s of the tray; zero before the start and from the end on."""
        if not 0.0 <= t_s < self.duration_s:
            return np.zeros(3)
        wave_number = 2.0 * math.pi / self.period_m
        slope = self.amplitude_m * wave_number * math.cos(wave_number * self.speed_mps * t_s)
        ax, ay = self._ahead
        return self.speed_mps * np.array([ax - slope * ay, ay + slope * ax, 0.0])

    def path_world(self, n: int) -> Array:
        """(n, 3) points of the way, evenly spaced in time."""
        return path_world(self, n)

    @cached_property
    def _ahead(self) -> Heading:
        return heading(self.start_m, self.end_m)
