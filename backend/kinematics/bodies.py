"""BodyTable: convex bodies around the robot as the contiguous arrays that the collision kernels read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.directions import fibonacci_sphere
from backend.kinematics.chain import row_of
from backend.kinematics.collision import BodyArrays
from backend.objects import Mesh
from backend.pose import Array, Pose

FACES_KEPT = 40
"""Of a part with more distinct faces, the largest ones; the directions of a sphere see to the rest."""

EVEN_DIRECTIONS = fibonacci_sphere(162)
"""No direction is further than 11 degrees from one of them."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """A box, or a union of convex parts, in its own frame."""

    name: str
    shape: Array
    """(8,) bounding sphere (4), half extents (3; zero when not a box), margin in metres."""
    role: int
    planes: tuple[Array, ...]
    """One (p, 4) set of half-spaces per convex part: outward normal and offset; none for a box."""
    parts: Array
    """(k, 4) one bounding sphere per convex part."""


def box_shape(name: str, size_m: tuple[float, float, float], role: int, margin_m: float) -> BodyShape:
    """A box of ``size_m`` around its frame's origin."""
    half = 0.5 * np.array(size_m)
    shape = np.array([0.0, 0.0, 0.0, np.linalg.norm(half), *half, margin_m])
    return BodyShape(name, shape, role, (), np.zeros((0, 4)))


def hull_shape(name: str, meshes: tuple[Mesh, ...], role: int, margin_m: float) -> BodyShape:
    """A body of convex meshes."""
    parts = np.array([_bounding_sphere(mesh.vertices) for mesh in meshes])
    whole = _bounding_sphere(np.concatenate([mesh.vertices for mesh in meshes]))
    shape = np.array([*whole, 0.0, 0.0, 0.0, margin_m])
    return BodyShape(name, shape, role, tuple(_half_spaces(mesh) for mesh in meshes), parts)


class BodyTable:
    """The bodies of a scene. Adding rebuilds the arrays; moving writes one row of ``arrays[0]``."""

    def __init__(self) -> None:
        self._shapes: list[BodyShape] = []
        self.arrays: BodyArrays = _pack([], np.zeros((0, 12)))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(shape.name for shape in self._shapes)

    def add(self, shape: BodyShape, T_world_body: Pose) -> int:
        """Add a body; its index."""
        self._shapes.append(shape)
        self.arrays = _pack(self._shapes, np.vstack([self.arrays[0], row_of(T_world_body.matrix)]))
        return len(self._shapes) - 1

    def move(self, index: int, T_world_body: Pose) -> None:
        """Put a body elsewhere."""
        self.arrays[0][index] = row_of(T_world_body.matrix)


def _pack(shapes: list[BodyShape], poses: Array) -> BodyArrays:
    kinds: list[tuple[int, int, int, int]] = []
    part_planes: list[tuple[int, int]] = []
    plane = 0
    for body in shapes:
        first = len(part_planes)
        for planes in body.planes:
            part_planes.append((plane, plane + len(planes)))
            plane += len(planes)
        kinds.append((body.role, int(not body.planes), first, len(part_planes)))
    return (
        np.ascontiguousarray(poses),
        np.array([body.shape for body in shapes]).reshape(-1, 8),
        np.array(kinds, dtype=np.int64).reshape(-1, 4),
        np.concatenate([np.zeros((0, 4)), *(body.parts for body in shapes)]),
        np.array(part_planes, dtype=np.int64).reshape(-1, 2),
        np.concatenate([np.zeros((0, 4)), *(planes for body in shapes for planes in body.planes)]),
    )


def _half_spaces(mesh: Mesh) -> Array:
    """(p, 4) supporting half-spaces: the largest faces, then even directions so that edges are not sharp.

    Any supporting half-space of a convex set bounds the distance from below. Beyond edges and corners faces
    alone fall short of it by up to 42 %, with the even directions by a few per cent.
    """
    normals, first = np.unique(np.round(mesh.face_normals, 3), axis=0, return_inverse=True)
    areas = np.bincount(first.ravel(), weights=mesh.face_areas_m2)
    largest = normals[np.argsort(-areas, kind="stable")[:FACES_KEPT]]
    largest = largest / np.linalg.norm(largest, axis=1, keepdims=True)
    directions = np.concatenate([largest, EVEN_DIRECTIONS])
    return np.column_stack([directions, (directions @ mesh.vertices.T).max(axis=1)])


def _bounding_sphere(points: Array) -> Array:
    """(4,) around the middle of the points' box."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return np.array([*center, np.linalg.norm(points - center, axis=1).max()])
