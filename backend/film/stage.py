"""Stage: everything that a film shows, as triangles that a snapshot puts in their places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray

from backend.looks import Geometry, box, chevrons, creased, joined, ribbon, ring
from backend.objects import load_object
from backend.pose import Array
from backend.robots.looks import Rgb, load_robot_parts
from backend.snapshot import SceneDescription, Snapshot

BELT: Rgb = (112, 121, 134)
ARROW: Rgb = (236, 239, 243)
TRAY: Rgb = (66, 75, 90)
BASE: Rgb = (150, 158, 170)
SLAB: Rgb = (186, 148, 116)
BELOW_TRAY_M = 0.002
ARROW_SPACING_M = 0.1
ARROW_WIDTH_M = 0.004


@dataclass(frozen=True, eq=False)
class Body:
    """Triangles that move together."""

    geometry: Geometry
    normals: Array
    """(n, 3) unit, of the vertices."""
    color: Rgb
    sheer: bool = False
    """Half transparent."""


class Stage:
    """One trial's bodies; ``placed`` is asked once per picture."""

    def __init__(self, scene: SceneDescription, now: Snapshot) -> None:
        """With what stands around ``now``."""
        self.made_at = now
        self._robot = load_robot_parts(scene.robot)
        self._bodies = [_body(part.geometry, part.color) for part in self._robot.parts]
        self._bodies += [_object(name) for name in (scene.object, *now.obstacles)]
        self._bodies += [_body(box(scene.tray_size_m, (0.0, 0.0, -0.5 * scene.tray_size_m[2])), TRAY)]
        still = [(_belt(scene), BELT), (_arrows(scene), ARROW), (ring(0.11, 0.125, 0.001), BASE)]
        self._bodies += [_body(geometry, color) for geometry, color in still]
        if now.slab is not None:
            self._bodies.append(_body(box(now.slab.size_m), SLAB, sheer=True))
        counts = [len(body.geometry.vertices) for body in self._bodies]
        offsets = np.cumsum([0, *counts[:-1]])
        per_face = [len(body.geometry.faces) for body in self._bodies]
        self.faces = np.concatenate(
            [body.geometry.faces + offset for body, offset in zip(self._bodies, offsets, strict=True)]
        ).astype(np.int32)
        self.colors: Array = np.repeat(
            np.array([body.color for body in self._bodies], dtype=np.float64), per_face, axis=0
        )
        self.sheer: NDArray[np.bool_] = np.repeat([body.sheer for body in self._bodies], per_face)

    def placed(self, snapshot: Snapshot) -> tuple[Array, Array]:
        """(n, 3) vertices and (n, 3) normals in the world, of a snapshot with the same things around."""
        links = self._robot.tree.link_poses(snapshot.joints_rad)
        Ts = [links[part.link] for part in self._robot.parts]
        Ts += [snapshot.T_world_object.matrix, *snapshot.Ts_world_obstacle, snapshot.T_world_tray.matrix]
        Ts += [np.eye(4)] * 3
        if snapshot.slab is not None:
            Ts.append(snapshot.slab.T_world_box.matrix)
        pairs = list(zip(self._bodies, Ts, strict=True))
        vertices = [body.geometry.vertices @ T[:3, :3].T + T[:3, 3] for body, T in pairs]
        normals = [body.normals @ T[:3, :3].T for body, T in pairs]
        return np.concatenate(vertices), np.concatenate(normals)


def _object(name: str) -> Body:
    shape = load_object(name)
    return _body(creased(shape.visual.as_trimesh()), shape.color_rgb)


def _body(geometry: Geometry, color: Rgb, *, sheer: bool = False) -> Body:
    mesh = trimesh.Trimesh(geometry.vertices, geometry.faces, process=False)
    return Body(geometry, np.asarray(mesh.vertex_normals), color, sheer)


def _belt(scene: SceneDescription) -> Geometry:
    _, width_m, height_m = scene.tray_size_m
    return ribbon(scene.belt_path_world, width_m, height_m - BELOW_TRAY_M)


def _arrows(scene: SceneDescription) -> Geometry:
    """Arrow heads on the belt, in the direction in which it runs."""
    _, width_m, height_m = scene.tray_size_m
    lift_m = BELOW_TRAY_M * 1.5 - height_m
    strokes = chevrons(scene.belt_path_world, ARROW_SPACING_M, width_m / 5, lift_m)
    return joined(*(ribbon(stroke, ARROW_WIDTH_M, 0.0) for stroke in strokes))
