"""Prism: an upright solid with a convex outline, for asking what stands clear of what."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.objects import ObjectDescription
from backend.objects.outline import convex_outline
from backend.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class Prism:
    """All points above and below a convex polygon, between two heights, in the world."""

    outline: Array
    """(n, 2) counter-clockwise."""
    low_m: float
    high_m: float

    @staticmethod
    def of_object(target: ObjectDescription, T_world_object: Pose) -> Prism:
        """The prism around an object that stands upright."""
        bottom = float(T_world_object.xyz_m[2])
        return Prism(placed(target.footprint_m, T_world_object), bottom, bottom + target.height_m)

    @staticmethod
    def of_box(size_m: tuple[float, float, float], T_world_box: Pose) -> Prism:
        """The prism of a level box given by the pose of its middle."""
        middle, half = float(T_world_box.xyz_m[2]), size_m[2] / 2
        return Prism(placed(rectangle(size_m[0], size_m[1]), T_world_box), middle - half, middle + half)

    def joined(self, other: Prism) -> Prism:
        """The smallest prism around both: what is swept on a straight way from one to the other."""
        outline = convex_outline(np.concatenate([self.outline, other.outline]))
        return Prism(outline, min(self.low_m, other.low_m), max(self.high_m, other.high_m))


def rectangle(length_m: float, width_m: float) -> Array:
    """(4, 2) counter-clockwise around the origin."""
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (length_m / 2, width_m / 2)


def placed(outline: Array, T_world_body: Pose) -> Array:
    """(n, 2) of the body frame, seen from above in the world."""
    return outline @ T_world_body.rotation[:2, :2].T + T_world_body.xyz_m[:2]


def apart(a: Prism, b: Prism, clearance_m: float) -> bool:
    """Whether the outlines are at least ``clearance_m`` apart, seen from above.

    By the separating axis theorem along the edges' normals, so never true of closer outlines; corners that
    face each other may be called too close up to 1.4 times the clearance.
    """
    normals = np.concatenate([_outward(a.outline), _outward(b.outline)])
    of_a, of_b = normals @ a.outline.T, normals @ b.outline.T
    gaps = np.maximum(of_b.min(axis=1) - of_a.max(axis=1), of_a.min(axis=1) - of_b.max(axis=1))
    return bool(gaps.max() >= clearance_m)


def clear_of_spheres(prism: Prism, spheres_world: Array, clearance_m: float) -> bool:
    """Whether the prism is at least ``clearance_m`` from all spheres (n, 4) of rows x, y, z, radius."""
    if len(spheres_world) == 0:
        return True
    sideways = distance_to_outline(prism.outline, spheres_world[:, :2])
    z = spheres_world[:, 2]
    upwards = np.maximum(np.maximum(prism.low_m - z, z - prism.high_m), 0.0)
    return bool((np.hypot(sideways, upwards) >= spheres_world[:, 3] + clearance_m).all())


def distance_to_outline(outline: Array, points: Array) -> Array:
    """(m,) distance of points (m, 2) from a convex polygon (n, 2), zero inside."""
    edges = np.roll(outline, -1, axis=0) - outline
    offsets = points[:, None] - outline
    along = np.clip((offsets * edges).sum(axis=-1) / (edges * edges).sum(axis=-1), 0.0, 1.0)
    to_edges = np.linalg.norm(offsets - along[..., None] * edges, axis=-1).min(axis=1)
    inside = (edges[:, 0] * offsets[..., 1] - edges[:, 1] * offsets[..., 0] >= 0.0).all(axis=1)
    return np.where(inside, 0.0, to_edges)


def _outward(outline: Array) -> Array:
    """(n, 2) unit normals of a counter-clockwise polygon's edges."""
    edges = np.roll(outline, -1, axis=0) - outline
    return np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1, keepdims=True)
