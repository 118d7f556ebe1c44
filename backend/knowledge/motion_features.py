"""What the motion-aware model is shown of a grasp and of the object's motion, the same in training and in use.

A grasp is shown as its position, all nine numbers of its rotation matrix and the position of its pregrasp. Euler
angles jump and quaternions have two signs, so neither is a continuous function of the grasp; two columns of the matrix
would be (Zhou et al. 2019, doi:10.1109/CVPR.2019.00589), and the third spares the network a cross product. The pregrasp
has the grasp's rotation, which is shown once. The direction of motion comes as sine and cosine, which do not jump at a
full turn.
"""

import numpy as np

from backend.pose import Array

GRASP_FEATURES = 15
MOTION_FEATURES = 3
FEATURES = GRASP_FEATURES + MOTION_FEATURES


def grasp_features(Ts_object_grasp: Array, backoff_m: float) -> Array:
    """(n, 15) of grasps (n, 4, 4): position, columns of the rotation, position of the pregrasp ``backoff_m`` behind."""
    position, rotation = Ts_object_grasp[:, :3, 3], Ts_object_grasp[:, :3, :3]
    columns = rotation.transpose(0, 2, 1).reshape(-1, 9)
    return np.concatenate([position, columns, position - backoff_m * rotation[:, :, 2]], axis=1)


def motion_features(speed_mps: Array, direction_rad: Array) -> Array:
    """(n, 3) of planar motions in the object frame: speed, sine and cosine of the direction from its x axis."""
    return np.stack([speed_mps, np.sin(direction_rad), np.cos(direction_rad)], axis=-1)
