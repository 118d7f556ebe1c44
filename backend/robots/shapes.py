"""A link's surface as a few convex pieces: hulls of slices, cut where cutting saves most empty volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from backend.directions import fibonacci_sphere
from backend.pose import Array

OVERLAP_M = 1e-3
"""Slices share a band this wide, so that no sliver of surface lies between two pieces."""


@dataclass(frozen=True, eq=False)
class ConvexPiece:
    """A convex polytope."""

    vertices: Array
    """(n, 3) metres."""
    planes: Array
    """(m, 4): outward unit normal and offset; inside where ``planes[:, :3] @ x + planes[:, 3] <= 0``."""

    def depth_m(self, points: Array) -> Array:
        """(n,) distance of the points (n, 3) to the nearest face; negative outside."""
        return -np.max(points @ self.planes[:, :3].T + self.planes[:, 3], axis=1)


def surface_points(mesh: trimesh.Trimesh, spacing_m: float, seed: int) -> Array:
    """(n, 3) the mesh's vertices, and random points on it about ``spacing_m`` apart."""
    count = int(np.clip(mesh.area / spacing_m**2, 200, 20_000))
    points = trimesh.sample.sample_surface(mesh, count, seed=seed)[0]
    return np.concatenate([np.asarray(mesh.vertices, dtype=np.float64), np.asarray(points, dtype=np.float64)])


def convex_pieces(points: Array, most: int, least_gain: float) -> list[ConvexPiece]:
    """Hulls that together hold all points (n, 3): at most ``most``; a cut saves ``least_gain`` of volume."""
    parts = [points]
    volume = ConvexHull(points).volume
    while len(parts) < most:
        cuts = [_best_cut(part) for part in parts]
        best = int(np.argmax([gain for gain, _ in cuts]))
        if cuts[best][0] < least_gain * volume:
            break
        parts[best : best + 1] = cuts[best][1]
    return [convex_piece(part) for part in parts]


def convex_piece(points: Array, directions: int = 150) -> ConvexPiece:
    """The hull of the points furthest along evenly spread directions and the six axes."""
    spread = np.concatenate([fibonacci_sphere(directions), np.eye(3), -np.eye(3)])
    chosen = points[np.unique(np.argmax(points @ spread.T, axis=0))]
    hull = ConvexHull(chosen)
    return ConvexPiece(chosen[hull.vertices], np.unique(hull.equations.round(9), axis=0))


def hull_mesh(piece: ConvexPiece) -> trimesh.Trimesh:
    """The piece as a triangle mesh."""
    return trimesh.convex.convex_hull(piece.vertices)


def _best_cut(points: Array) -> tuple[float, list[Array]]:
    """(volume saved in m^3, the two parts) of the best axis-aligned cut."""
    whole = ConvexHull(points).volume
    best: tuple[float, list[Array]] = (0.0, [points])
    for axis in range(3):
        low, high = points[:, axis].min(), points[:, axis].max()
        for fraction in np.linspace(0.1, 0.9, 17):
            at = low + fraction * (high - low)
            parts = [
                points[points[:, axis] <= at + OVERLAP_M / 2],
                points[points[:, axis] >= at - OVERLAP_M / 2],
            ]
            if min(len(part) for part in parts) < 20 or min(np.ptp(part[:, axis]) for part in parts) < 5e-3:
                continue
            saved = whole - sum(ConvexHull(part).volume for part in parts)
            if saved > best[0]:
                best = (saved, parts)
    return best
