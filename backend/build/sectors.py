"""From where a grasp comes: the five approach sectors of a standing object."""

import numpy as np
from numpy.typing import NDArray

from backend.pose import Array

SECTORS = ("top", "+x", "+y", "-x", "-y")
"""From above, or from that side of the object's frame."""
TOP = float(np.cos(np.radians(40.0)))
"""An approach within 40 degrees of straight down comes from the top."""


def sectors(Ts_object_grasp: Array) -> NDArray[np.int64]:
    """(n,) indices into ``SECTORS`` of grasps (n, 4, 4)."""
    came_from = -Ts_object_grasp[:, :3, 2]
    azimuth = np.arctan2(came_from[:, 1], came_from[:, 0])
    side = 1 + np.round(azimuth / (np.pi / 2)).astype(np.int64) % 4
    return np.where(came_from[:, 2] >= TOP, 0, side)


def count_by_sector(Ts_object_grasp: Array) -> dict[str, int]:
    """How many grasps (n, 4, 4) come from where."""
    counts = np.bincount(sectors(Ts_object_grasp), minlength=len(SECTORS))
    return dict(zip(SECTORS, counts.tolist(), strict=True))
