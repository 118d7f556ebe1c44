"""Where a new obstacle is put up: beside the belt, with room around it; from there it can be dragged."""

from __future__ import annotations

import numpy as np

from backend.errors import InvalidInputError
from backend.pose import Array
from backend.snapshot import SceneDescription, Snapshot

BESIDE_M = (0.20, 0.25, 0.30)
"""Distances from the belt's line that are tried; the paper's obstacles stand 15 to 25 cm from it."""
ALONG = (0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95)
"""Places along the belt that are tried, as shares of its way."""
FROM_BASE_M, FROM_OTHERS_M = 0.30, 0.22
"""Free space, level, between its middle and those of the robot's base, and of hand, tray, object and obstacles."""


def free_place(scene: SceneDescription, now: Snapshot) -> tuple[float, float]:
    """x, y (m) in the world, the far side of the belt first; raises ``InvalidInputError`` when all is taken."""
    path = scene.belt_path_world[:, :2]
    there = [now.T_world_tcp, now.T_world_tray, now.T_world_object]
    others = np.array([*(pose.xyz_m[:2] for pose in there), *now.Ts_world_obstacle[:, :2, 3]])
    for aside_m in BESIDE_M:
        for share in ALONG:
            for place in _beside(path, share, aside_m):
                room = np.linalg.norm(others - place, axis=1).min() >= FROM_OTHERS_M
                off_belt = np.linalg.norm(path - place, axis=1).min() >= min(BESIDE_M) - 0.05
                if room and off_belt and np.linalg.norm(place) >= FROM_BASE_M:
                    return float(place[0]), float(place[1])
    raise InvalidInputError("There is no free place beside the belt: remove an obstacle first.")


def _beside(path: Array, share: float, aside_m: float) -> list[Array]:
    """The two places at a distance from a point of the belt, the one further from the robot first."""
    k = round(share * (len(path) - 1))
    ahead = path[min(k + 1, len(path) - 1)] - path[max(k - 1, 0)]
    aside = np.array([-ahead[1], ahead[0]]) / max(float(np.linalg.norm(ahead)), 1e-9)
    places = [path[k] + aside_m * aside, path[k] - aside_m * aside]
    return sorted(places, key=lambda place: -float(np.linalg.norm(place)))
