"""Mesh: a triangle mesh as two arrays, with what physics, planners and grasp samplers ask of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backend.pose import Array

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, counter-clockwise seen from outside. Loads in milliseconds, where trimesh takes most of a second."""

    vertices: Array
    """(n, 3) metres."""
    faces: NDArray[np.int64]
    """(m, 3) rows of ``vertices``."""

    @cached_property
    def triangles(self) -> Array:
        """(m, 3, 3) the corners of each face."""
        return self.vertices[self.faces]

    @cached_property
    def face_normals(self) -> Array:
        """(m, 3) outward unit normals."""
        return self._crosses / np.linalg.norm(self._crosses, axis=1, keepdims=True)

    @cached_property
    def face_areas_m2(self) -> Array:
        """(m,)."""
        return 0.5 * np.linalg.norm(self._crosses, axis=1)

    @cached_property
    def bounds_m(self) -> Array:
        """(2, 3) the lowest and the highest coordinates."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def volume_m3(self) -> float:
        """Enclosed volume; the mesh must be closed."""
        return float(self._six_volumes.sum() / 6.0)

    @cached_property
    def center_of_mass_m(self) -> Array:
        """(3,) for uniform density; the mesh must be closed."""
        return self._six_volumes @ self.triangles.sum(axis=1) / (24.0 * self.volume_m3)

    @cached_property
    def inertia_m5(self) -> Array:
        """(3, 3) about the centre of mass for a density of one; the mesh must be closed.

        The second moment of a tetrahedron with one corner at the origin is
        ``volume / 20 * (sum of outer(c, c) over its corners c + outer(s, s))`` with ``s`` their sum.
        """
        sums = self.triangles.sum(axis=1)
        weights = self._six_volumes / 120.0
        second = np.einsum("t,tci,tcj->ij", weights, self.triangles, self.triangles)
        second += np.einsum("t,ti,tj->ij", weights, sums, sums)
        second -= self.volume_m3 * np.outer(self.center_of_mass_m, self.center_of_mass_m)
        return np.trace(second) * np.eye(3) - second

    def as_trimesh(self) -> trimesh.Trimesh:
        """The same mesh for everything else that can be asked of one."""
        import trimesh

        return trimesh.Trimesh(vertices=self.vertices, faces=self.faces, process=False)

    @cached_property
    def _crosses(self) -> Array:
        a, b, c = self.triangles.transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @cached_property
    def _six_volumes(self) -> Array:
        """(m,) six times the signed volume between each face and the origin."""
        return np.einsum("ij,ij->i", self.triangles[:, 0], self._crosses)
