"""Picture: a snapshot as pixels."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from backend.film.camera import Camera, Sun, camera_for
from backend.film.raster import NOTHING, Ints, Light, Seen, Surface, cover, lay_ground, shade
from backend.film.stage import Stage
from backend.objects import load_object
from backend.pose import Array
from backend.snapshot import SceneDescription, Snapshot

Pixels = NDArray[np.uint8]
ROBOT_M = np.array([(x, y, z) for x in (-0.15, 0.15) for y in (-0.15, 0.15) for z in (0.0, 0.75)])
"""Corners of what an arm takes up in most postures."""
FINER = 2
"""Pictures are drawn so many times as wide and high, then averaged."""
SUN = np.array([0.25, -0.35, 0.9]) / np.linalg.norm([0.25, -0.35, 0.9])
SUN_MAP = 1400
LIT_M = 1.4
TONES = np.array(
    [(252, 253, 254), (240, 243, 246), (243, 245, 247), (222, 226, 231), (196, 203, 211)], dtype=np.float64
)
"""Sky above and below; floor, its cells, its sections."""


class Painter:
    """Draws the snapshots of one trial from one place."""

    def __init__(self, scene: SceneDescription, first: Snapshot, width: int, height: int) -> None:
        """``first`` is how the trial begins: all of it will be in the picture."""
        self._scene = scene
        self._stage = Stage(scene, first)
        self._camera = camera_for(_marks(scene, first), scene, FINER * width, FINER * height)
        middle_m = scene.belt_path_world.mean(axis=0)
        self._sun = Sun(
            np.array([0.5 * middle_m[0], 0.5 * middle_m[1], 0.3]), LIT_M, SUN_MAP, _turned(SUN, self._camera)
        )
        camera, sun = self._camera, _sun_matrix(self._sun)
        self._ground = lay_ground(camera.height, camera.width, camera.eye_m, _rays(camera), sun, TONES)

    def paint(self, snapshot: Snapshot) -> Pixels:
        """(height, width, 3)."""
        if not snapshot.stands_as(self._stage.made_at):
            self._stage = Stage(self._scene, snapshot)
        stage, camera, sun = self._stage, self._camera, self._sun
        points, normals = stage.placed(snapshot)
        sun_map, _ = self._covered(sun.project(points), (SUN_MAP, SUN_MAP))
        corners = camera.project(points)
        nearness, which = self._covered(corners, (camera.height, camera.width))
        surface = Surface(points, normals, stage.faces, stage.colors)
        light = Light(_sun_matrix(sun), sun_map, self._ground)
        return shade(surface, Seen(corners, nearness, which, camera.eye_m), light, FINER)

    def pixel_of(self, point_world: Array) -> Array:
        """(3,) pixel x and y, and nearness, of a point (3,) in what ``paint`` gives."""
        x, y, near = self._camera.project(point_world[None])[0]
        return np.array([x / FINER, y / FINER, near])

    def _covered(self, corners: Array, shape: tuple[int, int]) -> tuple[Array, Ints]:
        nearness, which = np.zeros(shape), np.full(shape, NOTHING, dtype=np.int32)
        cover(corners, self._stage.faces, self._stage.sheer, nearness, which)
        return nearness, which


def _marks(scene: SceneDescription, first: Snapshot) -> Array:
    """(n, 3) what has to be in the picture: the robot, the belt, obstacles, the slab."""
    boxes = [
        (T, load_object(name).visual.bounds_m) for name, T in zip(scene.obstacles, first.Ts_world_obstacle, strict=True)
    ]
    if scene.slab is not None:
        half = 0.5 * np.array(scene.slab.size_m)
        boxes.append((scene.slab.T_world_box.matrix, np.stack([-half, half])))
    corners = [np.array(list(product(*bounds.T))) @ T[:3, :3].T + T[:3, 3] for T, bounds in boxes]
    above = scene.belt_path_world + np.array([0.0, 0.0, 0.15])
    return np.concatenate([ROBOT_M, scene.belt_path_world, above, *corners])


def _turned(direction: Array, camera: Camera) -> Array:
    """The light comes over the photographer's shoulder."""
    away = camera.eye_m - camera.aim_m
    cos, sin = away[:2] / np.linalg.norm(away[:2])
    return np.array([cos * direction[0] - sin * direction[1], sin * direction[0] + cos * direction[1], direction[2]])


def _rays(camera: Camera) -> Array:
    """(3, 3): the ray through pixel (x, y) is this times (x, y, 1)."""
    f = camera.focal_px
    pixel = np.array(
        [[1.0 / f, 0.0, -0.5 * camera.width / f], [0.0, 1.0 / f, -0.5 * camera.height / f], [0.0, 0.0, 1.0]]
    )
    return camera.rotation.T @ pixel


def _sun_matrix(sun: Sun) -> Array:
    """(4, 4): world to the map in three rows, the direction towards the light in the last."""
    half = 0.5 * sun.size
    scale = np.array([half, half, 0.5])
    linear = sun.rotation * (scale / sun.radius_m)[:, None]
    shift = np.array([half, half, 1.0]) - linear @ sun.center_m
    return np.vstack([np.column_stack([linear, shift]), [*sun.direction, 0.0]])
