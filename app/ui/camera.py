"""Where the scene is looked at from: so that arm and belt fill the picture."""

from __future__ import annotations

import threading

import numpy as np
import viser

from backend.pose import Array
from backend.snapshot import SceneDescription

FIELD_OF_VIEW_RAD = 0.8
SIDE_RAD = 0.55
"""The view is turned this much from the line between robot and belt, so that neither hides the other."""
ELEVATION_RAD = 0.55
SAME_PLACE_M = 0.02


def viewpoint(scene: SceneDescription) -> tuple[Array, Array]:
    """Camera position and the point it looks at, (3,) each, in the world."""
    path = scene.belt_path_world
    middle = path.mean(axis=0)
    spread_m = float(np.linalg.norm(path - middle, axis=1).max())
    reach_m = float(np.linalg.norm(middle[:2]))
    look_at = np.array([0.5 * middle[0], 0.5 * middle[1], 0.22])
    outward_rad = np.arctan2(middle[1], middle[0]) if reach_m > 0.1 else 0.0
    turn = outward_rad + SIDE_RAD
    direction = np.array([np.cos(turn), np.sin(turn), np.tan(ELEVATION_RAD)])
    direction /= np.linalg.norm(direction)
    distance_m = 0.9 + 1.1 * max(spread_m, 0.4) + 0.5 * reach_m
    return look_at + distance_m * direction, look_at


class CameraKeeper:
    """Gives every trial a good view, but never takes the camera out of somebody's hand."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._lock = threading.Lock()
        self._preset: tuple[Array, Array] | None = None

    def begin(self, scene: SceneDescription) -> None:
        """Move every camera that stands where it was put; new browsers start at the new place."""
        with self._lock:
            before, self._preset = self._preset, viewpoint(scene)
            position, look_at = self._preset
        self._server.initial_camera.position = position
        self._server.initial_camera.look_at = look_at
        self._server.initial_camera.fov = FIELD_OF_VIEW_RAD
        for client in self._server.get_clients().values():
            if before is not None and np.linalg.norm(client.camera.position - before[0]) < SAME_PLACE_M:
                self.reset(client)

    def reset(self, client: viser.ClientHandle) -> None:
        """Back to the view of this trial."""
        with self._lock:
            if self._preset is None:
                return
            position, look_at = self._preset
        with client.atomic():
            client.camera.position = position
            client.camera.look_at = look_at
