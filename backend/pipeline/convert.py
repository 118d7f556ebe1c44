"""convert: a predicted pose and the grasp database -> Candidates in the world."""

import numpy as np

from backend.knowledge.grasps import GraspDatabase
from backend.pipeline.values import Candidates
from backend.pose import Pose


def convert(grasps: GraspDatabase, T_world_object: Pose, backoff_m: float) -> Candidates:
    """Every grasp at the predicted pose; pregrasps lie ``backoff_m`` behind along the approach."""
    back = np.eye(4)
    back[2, 3] = -backoff_m
    Ts_world_grasp = T_world_object.matrix @ grasps.Ts_object_grasp
    quality = grasps.successes / np.maximum(grasps.lifts, 1)
    return Candidates(grasps.Ts_object_grasp, Ts_world_grasp, Ts_world_grasp @ back, quality, T_world_object)
