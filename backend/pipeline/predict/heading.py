"""Pose as the four numbers that predictors move: position and an unwrapped yaw; roll and pitch stay as seen."""

import numpy as np

from backend.pipeline.values import Observation
from backend.pose import Array, Pose


def measured(observation: Observation, previous_yaw_rad: float | None) -> Array:
    """(4,) x, y, z in metres and yaw in radians, within pi of ``previous_yaw_rad``; the detection must be there."""
    pose = observation.T_world_object
    assert pose is not None
    yaw = pose.yaw_rad
    if previous_yaw_rad is not None:
        yaw += 2 * np.pi * np.round((previous_yaw_rad - yaw) / (2 * np.pi))
    return np.array([*pose.xyz_m, yaw])


def tilt_of(pose: Pose) -> Array:
    """(3, 3) what is left of a rotation without its yaw."""
    return Pose.from_xyz_yaw((0.0, 0.0, 0.0), -pose.yaw_rad).rotation @ pose.rotation


def poses(states: Array, tilt: Array) -> Array:
    """(n, 4, 4) poses of (n, 4) states whose roll and pitch are those of ``tilt``."""
    out = np.zeros((len(states), 4, 4))
    cos, sin = np.cos(states[:, 3]), np.sin(states[:, 3])
    turn = np.zeros((len(states), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1] = cos, -sin
    turn[:, 1, 0], turn[:, 1, 1] = sin, cos
    turn[:, 2, 2] = 1.0
    out[:, :3, :3] = turn @ tilt
    out[:, :3, 3] = states[:, :3]
    out[:, 3, 3] = 1.0
    return out
