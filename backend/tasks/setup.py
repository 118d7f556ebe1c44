"""TrialSetup: how one trial begins, as drawn from a seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.motions import Motion
from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose
from backend.snapshot import BoxPlacement

TRAY_THICKNESS_M = 0.02
TRAY_SIDE_M = 0.10
TRAY_RIM_M = 0.005
"""The tray reaches at least this far beyond what the object stands on."""
BASE_HEIGHT_M = 0.002
"""What is lower than this above the object's bottom counts as what it stands on."""


@dataclass(frozen=True, eq=False)
class TrialSetup:
    """Everything that chance decides before a trial."""

    motion: Motion
    """Of the tray: the middle of its top face."""
    object_yaw_rad: float
    """T_tray_object is this yaw, in (-pi, pi], about the middle of the tray's top face."""
    tray_size_m: tuple[float, float, float]
    obstacles: tuple[tuple[str, Pose], ...] = ()
    """Object names and T_world_obstacle, standing on the floor."""
    slab: BoxPlacement | None = None

    @property
    def T_tray_object(self) -> Pose:
        """Where the object stands on the tray at the start."""
        return Pose.from_xyz_yaw((0.0, 0.0, 0.0), self.object_yaw_rad)


def tray_size_m(target: ObjectDescription, yaw_rad: float) -> tuple[float, float, float]:
    """10 x 10 x 2 cm, made longer or wider where the object's base, turned by ``yaw_rad``, needs it."""
    half = np.abs(base_points(target) @ _turn(yaw_rad).T).max(axis=0) + TRAY_RIM_M
    x, y = np.maximum(2.0 * half, TRAY_SIDE_M).tolist()
    return x, y, TRAY_THICKNESS_M


def base_points(target: ObjectDescription) -> Array:
    """(n, 2) corners, in the object frame, that the object stands on."""
    corners = np.concatenate([np.asarray(part.vertices) for part in target.convex_parts])
    return corners[corners[:, 2] < BASE_HEIGHT_M, :2]


def _turn(yaw_rad: float) -> Array:
    return Pose.from_xyz_yaw((0.0, 0.0, 0.0), yaw_rad).rotation[:2, :2]
