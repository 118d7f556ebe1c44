"""Where the scene is looked at from: so that arm and belt fill the picture."""

from __future__ import annotations

import threading

import numpy as np
import viser

from app.reports import Started
from app.session import Session
from backend.pose import Array
from backend.snapshot import SceneDescription

FIELD_OF_VIEW_RAD = 0.8
SIDE_RAD = 0.55
"""The view is turned this much from the line between robot and belt, so that neither hides the other."""
ELEVATION_RAD = 0.55
LOOK_AT_HEIGHT_M = 0.05
"""Lower than the arm's middle, so that the belt stays clear of the timeline."""
PRESETS = ("Overview", "Above", "Side", "Close")
SAME_PLACE_M = 0.02
ELBOW_M = 0.25
"""How far an arm may reach sideways beyond belt and base."""
BACK_FOR_TWO = 1.2
"""Metres that the camera stands back for each metre between two worlds."""


CLOSE_M = 0.75
"""From the object, for a close look."""
Viewpoint = tuple[Array, Array]
"""Camera position and the point it looks at, (3,) each, in the world."""


def beside_m(started: Started) -> Array | None:
    """(3,) from a world to the one drawn beside it, to the right of the overview and clear of each other's arms.

    None where nothing is compared.
    """
    scene = started.scene
    if started.restart.compare is None:
        return None
    view_rad = _outward_rad(scene) + SIDE_RAD
    right = np.array([-np.sin(view_rad), np.cos(view_rad), 0.0])
    places_m = np.append(scene.belt_path_world @ right, 0.0)  # belt and base
    return (np.ptp(places_m) + 2.0 * ELBOW_M) * right


def viewpoint(scene: SceneDescription, shift_m: Array | None = None) -> Viewpoint:
    """From where arm and belt fill the picture."""
    return viewpoints(scene, shift_m)["Overview"]


def viewpoints(scene: SceneDescription, shift_m: Array | None = None) -> dict[str, Viewpoint]:
    """Presets by name; they turn with the belt, which lies anywhere around the robot.

    With ``shift_m`` (3,) there is a second world, so far from the first; all but the close look have both in view.
    """
    between_m = np.zeros(3) if shift_m is None else shift_m / 2
    path = scene.belt_path_world
    middle = path.mean(axis=0)
    spread_m = max(float(np.linalg.norm(path - middle, axis=1).max()), 0.4)
    reach_m = float(np.linalg.norm(middle[:2]))
    outward_rad = _outward_rad(scene)
    center = between_m + np.array([0.5 * middle[0], 0.5 * middle[1], LOOK_AT_HEIGHT_M])
    above = between_m + np.array([0.8 * middle[0], 0.8 * middle[1], LOOK_AT_HEIGHT_M])
    distance_m = 1.0 + 1.15 * spread_m + 0.5 * reach_m + BACK_FOR_TWO * 2.0 * float(np.linalg.norm(between_m))
    return {
        "Overview": (center + distance_m * _direction(outward_rad + SIDE_RAD, ELEVATION_RAD), center),
        "Above": (above + 1.1 * distance_m * _direction(outward_rad, np.pi / 2 - 0.01), above),
        "Side": (center + distance_m * _direction(outward_rad + np.pi / 2, 0.12), center),
        "Close": (middle + CLOSE_M * _direction(outward_rad + SIDE_RAD, ELEVATION_RAD), middle),
    }


def _outward_rad(scene: SceneDescription) -> float:
    """Direction from the robot to the middle of the belt."""
    x_m, y_m, _ = scene.belt_path_world.mean(axis=0)
    return float(np.arctan2(y_m, x_m)) if np.hypot(x_m, y_m) > 0.1 else 0.0


def _direction(turn_rad: float, elevation_rad: float) -> Array:
    level = np.cos(elevation_rad)
    return np.array([level * np.cos(turn_rad), level * np.sin(turn_rad), np.sin(elevation_rad)])


class CameraKeeper:
    """Gives every trial a good view, but never takes the camera out of somebody's hand."""

    def __init__(self, server: viser.ViserServer, session: Session) -> None:
        self._server = server
        self._session = session
        self._lock = threading.Lock()
        self._presets: dict[str, Viewpoint] = {}

    def begin(self, started: Started) -> None:
        """Move every camera that stands where it was put; new browsers start at the new place."""
        with self._lock:
            before, self._presets = self._presets, viewpoints(started.scene, beside_m(started))
            position, look_at = self._presets["Overview"]
        self._server.initial_camera.position = position
        self._server.initial_camera.look_at = look_at
        self._server.initial_camera.fov = FIELD_OF_VIEW_RAD
        for client in self._server.get_clients().values():
            for name, (was, _) in before.items():
                if np.linalg.norm(client.camera.position - was) < SAME_PLACE_M:
                    self.go(client, name)
                    break

    def go(self, client: viser.ClientHandle, name: str = "Overview") -> None:
        """To a preset of this trial; nothing when there is none of that name."""
        with self._lock:
            if name not in self._presets:
                return
            position, look_at = self._presets[name]
        snapshot = self._session.state.shown.snapshot
        if name == "Close" and snapshot is not None:
            offset = snapshot.T_world_object.xyz_m - look_at
            position, look_at = position + offset, look_at + offset
        with client.atomic():
            client.camera.position = position
            client.camera.look_at = look_at
