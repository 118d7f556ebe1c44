"""Camera: a pinhole that looks at a point, world z upwards in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backend.pose import Array
from backend.snapshot import SceneDescription

FIELD_OF_VIEW_RAD = 0.72
"""From top to bottom."""
SIDE_RAD = 0.62
"""The view is turned this much from the line between robot and belt, so that neither hides the other."""
ELEVATION_RAD = 0.5
NEAREST_M = 0.8
ROOM = ((0.05, 0.06), (0.95, 0.82))
"""Part of the picture for what happens, left, top, right and bottom: the caption stands below."""


@dataclass(frozen=True, eq=False)
class Camera:
    """Where a picture of ``width`` x ``height`` pixels is taken from."""

    eye_m: Array
    """(3,)."""
    aim_m: Array
    """(3,)."""
    width: int
    height: int

    @cached_property
    def rotation(self) -> Array:
        """(3, 3) rows: right, down and forward, in the world."""
        forward = self.aim_m - self.eye_m
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(forward, right), forward])

    @property
    def focal_px(self) -> float:
        return 0.5 * self.height / np.tan(0.5 * FIELD_OF_VIEW_RAD)

    def project(self, points_world: Array) -> Array:
        """(n, 3) pixel x, pixel y and nearness (1 / depth in m, negative behind the eye) of points (n, 3)."""
        x, y, z = self.rotation @ (points_world - self.eye_m).T
        near = 1.0 / z
        f = self.focal_px
        return np.stack([0.5 * self.width + f * x * near, 0.5 * self.height + f * y * near, near], axis=1)


def camera_for(marks_m: Array, scene: SceneDescription, width: int, height: int) -> Camera:
    """As near as it can be with all ``marks_m`` (n, 3) in the picture; it turns with the belt, which lies anywhere."""
    middle = scene.belt_path_world.mean(axis=0)
    far = float(np.linalg.norm(middle[:2])) > 0.1
    turn_rad = SIDE_RAD + (float(np.arctan2(middle[1], middle[0])) if far else 0.0)
    level = np.cos(ELEVATION_RAD)
    away = np.array([level * np.cos(turn_rad), level * np.sin(turn_rad), np.sin(ELEVATION_RAD)])
    aim_m = 0.5 * (marks_m.min(axis=0) + marks_m.max(axis=0))
    distance_m = NEAREST_M
    while True:
        camera, fits = _centred(Camera(aim_m + distance_m * away, aim_m, width, height), marks_m)
        if fits:
            return camera
        distance_m *= 1.04


def _centred(camera: Camera, marks_m: Array) -> tuple[Camera, bool]:
    """The camera moved sideways until the marks are in the middle of their room; whether they fit in there."""
    room = np.array(ROOM) * (camera.width, camera.height)
    for _ in range(3):
        extent = _extent(camera, marks_m)
        if extent is None:
            return camera, False
        off = extent.mean(axis=0) - room.mean(axis=0)
        depth_m = float(np.linalg.norm(camera.eye_m - camera.aim_m))
        shift_m = off / camera.focal_px * depth_m @ camera.rotation[:2]
        camera = Camera(camera.eye_m + shift_m, camera.aim_m + shift_m, camera.width, camera.height)
    extent = _extent(camera, marks_m)
    fits = extent is not None and bool((extent[0] >= room[0] - 1.0).all() and (extent[1] <= room[1] + 1.0).all())
    return camera, fits


def _extent(camera: Camera, marks_m: Array) -> Array | None:
    """(2, 2) least and largest pixel x, y of points (n, 3); None when one is behind the eye."""
    seen = camera.project(marks_m)
    if (seen[:, 2] <= 0.0).any():
        return None
    return np.stack([seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)])


@dataclass(frozen=True, eq=False)
class Sun:
    """Parallel light, and the square map of what it meets first."""

    center_m: Array
    """(3,) of the lit region."""
    radius_m: float
    size: int
    """Pixels of the map's side."""
    direction: Array
    """(3,) unit vector towards the light."""

    @cached_property
    def rotation(self) -> Array:
        """(3, 3) rows: the map's x and y, and towards the light."""
        right = np.cross(self.direction, (0.0, 0.0, 1.0))
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(self.direction, right), self.direction])

    def project(self, points_world: Array) -> Array:
        """(n, 3) map x, map y and nearness (1 at the middle, more towards the light) of points (n, 3)."""
        x, y, z = self.rotation @ (points_world - self.center_m).T / self.radius_m
        half = 0.5 * self.size
        return np.stack([half + half * x, half + half * y, 1.0 + 0.5 * z], axis=1)
