"""ObjectField: an object's signed distance on a grid, for samplers that ask about many points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import KDTree

from backend.kinematics.compiled import kernel
from backend.objects import Mesh, ObjectDescription
from backend.pose import Array

CELL_M = 0.004
ROUND_M = 0.07
"""The grid goes on that far around the object; beyond, distances are those to the grid's border and more."""
SURFACE_POINTS = 60_000

FieldArrays = tuple[Array, Array, float]
"""values (nx, ny, nz) metres; origin (3,) metres; cell in metres."""


@dataclass(frozen=True, eq=False)
class ObjectField:
    """Signed distance to an object's surface, negative inside, in the object frame."""

    values: Array
    """(nx, ny, nz) metres."""
    origin_m: Array
    """(3,) of ``values[0, 0, 0]``."""

    @property
    def arrays(self) -> FieldArrays:
        """For kernels."""
        return self.values, self.origin_m, CELL_M

    @staticmethod
    def of(target: ObjectDescription) -> ObjectField:
        """The field of the convex parts' union: what the physics sees."""
        low, high = _bounds(target.convex_parts)
        origin = low - ROUND_M
        counts = np.ceil((high - low + 2 * ROUND_M) / CELL_M).astype(int) + 1
        axes = [origin[k] + CELL_M * np.arange(counts[k]) for k in range(3)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        depth = np.min([_above_planes(part, points) for part in target.convex_parts], axis=0)
        tree = KDTree(_outer_surface(target.convex_parts))
        distance = np.asarray(tree.query(points)[0], dtype=np.float64)
        values = np.where(depth < 0.0, -distance, distance)
        return ObjectField(np.ascontiguousarray(values.reshape(tuple(counts))), origin)


@kernel
def distance_at(field: FieldArrays, x: float, y: float, z: float) -> float:
    """Trilinear; outside the grid the value at its border plus the way to there."""
    values, origin, cell = field
    out = 0.0
    at = np.empty(3)
    first = np.empty(3, np.int64)
    for k in range(3):
        u = ((x, y, z)[k] - origin[k]) / cell
        most = values.shape[k] - 1.000001
        inside = min(max(u, 0.0), most)
        out += ((u - inside) * cell) ** 2
        first[k] = int(inside)
        at[k] = inside - first[k]
    i, j, k = first
    u, v, w = at
    low = (values[i, j, k] * (1 - w) + values[i, j, k + 1] * w) * (1 - v) + (
        values[i, j + 1, k] * (1 - w) + values[i, j + 1, k + 1] * w
    ) * v
    high = (values[i + 1, j, k] * (1 - w) + values[i + 1, j, k + 1] * w) * (1 - v) + (
        values[i + 1, j + 1, k] * (1 - w) + values[i + 1, j + 1, k + 1] * w
    ) * v
    return low * (1 - u) + high * u + np.sqrt(out)


def _bounds(parts: tuple[Mesh, ...]) -> tuple[Array, Array]:
    return (
        np.min([part.bounds_m[0] for part in parts], axis=0),
        np.max([part.bounds_m[1] for part in parts], axis=0),
    )


def _above_planes(part: Mesh, points: Array) -> Array:
    """(n,) negative inside the convex part, nowhere else."""
    above = np.full(len(points), np.inf)
    near = ((points >= part.bounds_m[0]) & (points <= part.bounds_m[1])).all(axis=1)
    above[near] = _over_planes(part, points[near])
    return above


def _over_planes(part: Mesh, points: Array) -> Array:
    normals, first = np.unique(np.round(part.face_normals, 6), axis=0, return_index=True)
    offsets = np.einsum("ij,ij->i", part.face_normals[first], part.triangles[first, 0])
    above = np.full(len(points), -np.inf)
    for normal, offset in zip(normals, offsets.tolist(), strict=True):
        np.maximum(above, points @ normal - offset, out=above)
    return above


def _outer_surface(parts: tuple[Mesh, ...]) -> Array:
    """(n, 3) points of the parts' surfaces that lie inside no other part."""
    area = sum(float(part.face_areas_m2.sum()) for part in parts)
    points: list[Array] = []
    for k, part in enumerate(parts):
        count = int(SURFACE_POINTS * float(part.face_areas_m2.sum()) / area)
        drawn = np.asarray(trimesh.sample.sample_surface(part.as_trimesh(), count, seed=k)[0], dtype=np.float64)
        for other in (*parts[:k], *parts[k + 1 :]):
            drawn = drawn[_above_planes(other, drawn) > -1e-6]
        points.append(drawn)
    return np.concatenate(points)
