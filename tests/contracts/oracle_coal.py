"""An independent judge of what overlaps: the collision library coal."""

import importlib
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.objects import load_object
from backend.pose import Array, Pose

coal: Any = importlib.import_module("coal")


class Solid:
    """A few convex shapes that move together, none of them further than ``reach_m`` from the pose."""

    def __init__(self, shapes: Sequence[Any], pose: Pose, reach_m: float) -> None:
        transform = coal.Transform3s(np.array(pose.rotation), np.array(pose.xyz_m))
        self._bodies = [coal.CollisionObject(shape, transform) for shape in shapes]
        self._middle, self._reach_m = pose.xyz_m, reach_m

    def overlaps(self, other: "Solid") -> bool:
        """Whether any shape of one touches any of the other."""
        apart_m = float(np.linalg.norm(self._middle - other._middle))
        if apart_m > self._reach_m + other._reach_m:
            return False
        return any(_touch(a, b) for a in self._bodies for b in other._bodies)


def object_solid(name: str, T_world_object: Pose) -> Solid:
    """An object's convex parts."""
    shapes, reach_m = _shapes(name)
    return Solid(shapes, T_world_object, reach_m)


def box_solid(size_m: tuple[float, float, float], T_world_box: Pose) -> Solid:
    """A box by the pose of its middle."""
    return Solid([coal.Box(*size_m)], T_world_box, float(np.linalg.norm(size_m)) / 2)


def sphere_solids(spheres_world: Array) -> list[Solid]:
    """One for each row x, y, z, radius."""
    return [Solid([coal.Sphere(row[3])], Pose.of(row[:3]), float(row[3])) for row in spheres_world]


@cache
def _shapes(name: str) -> tuple[list[Any], float]:
    parts = load_object(name).convex_parts
    reach_m = max(float(np.linalg.norm(part.vertices, axis=1).max()) for part in parts)
    return [_convex(part.vertices, part.faces) for part in parts], reach_m


def _convex(vertices: Array, faces: NDArray[np.int64]) -> Any:
    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in vertices:
        points.append(np.asarray(vertex, dtype=np.float64))
    for a, b, c in faces.tolist():
        triangles.append(coal.Triangle(a, b, c))
    return coal.Convex(points, triangles)


def _touch(a: Any, b: Any) -> bool:
    return coal.collide(a, b, coal.CollisionRequest(), coal.CollisionResult()) > 0
