"""CanGrasp: is the hand near enough to the grasp, and turned rightly, for the approach to begin?"""

import numpy as np

from backend.methods.method import Execution
from backend.pose import Array, rotation_angle_rad


def can_grasp(T_world_tcp: Array, T_world_grasp: Array, backoff_m: float, config: Execution) -> bool:
    """The paper's condition (section IV-A) on two (4, 4) poses at the same moment."""
    distance = float(np.linalg.norm(T_world_tcp[:3, 3] - T_world_grasp[:3, 3]))
    angle = rotation_angle_rad(T_world_tcp[:3, :3], T_world_grasp[:3, :3])
    return distance <= config.position_factor * backoff_m and angle <= config.angle_rad
