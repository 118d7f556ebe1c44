"""Where a slab hangs that people hold above a running belt."""

import numpy as np

from backend.motions import Motion
from backend.pose import Pose
from backend.snapshot import BoxPlacement

SLAB_WIDTH_M, SLAB_THICKNESS_M = 0.10, 0.02
"""As in the paper's task."""
PATH_SAMPLES = 121


def slab_above(motion: Motion, height_m: float) -> BoxPlacement:
    """A level slab as long as the belt's start is from its end, its underside ``height_m`` above the tray's top."""
    path = motion.path_world(PATH_SAMPLES)
    ahead = path[-1, :2] - path[0, :2]
    length_m = float(np.linalg.norm(ahead))
    if length_m < 1e-6:  # a full circle
        ahead, length_m = np.array([1.0, 0.0]), float(np.ptp(path[:, 0]))
    ahead = ahead / np.linalg.norm(ahead)
    aside = path[:, :2] @ np.array([-ahead[1], ahead[0]])
    along = path[:, :2] @ ahead
    middle = 0.5 * (along.min() + along.max()) * ahead + aside.mean() * np.array([-ahead[1], ahead[0]])
    z = float(path[:, 2].max()) + height_m + SLAB_THICKNESS_M / 2
    pose = Pose.from_xyz_yaw((*middle.tolist(), z), float(np.arctan2(ahead[1], ahead[0])))
    return BoxPlacement(pose, (length_m, SLAB_WIDTH_M, SLAB_THICKNESS_M))
