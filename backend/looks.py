"""Looks: shapes as they are drawn, on the page and in films, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from backend.pose import Array

CREASE_RAD = 0.6
"""Edges sharper than this are drawn as edges, not rounded by shading."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """A triangle mesh."""

    vertices: Array
    """(n, 3) metres."""
    faces: NDArray[np.int64]
    """(m, 3)."""


def moved(geometry: Geometry, T: Array) -> Geometry:
    """The same mesh at a pose (4, 4)."""
    return Geometry(geometry.vertices @ T[:3, :3].T + T[:3, 3], geometry.faces)


def joined(*parts: Geometry) -> Geometry:
    """All parts as one mesh."""
    offsets = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + offset for part, offset in zip(parts, offsets, strict=False)]
    return Geometry(np.concatenate([part.vertices for part in parts]), np.concatenate(faces))


def creased(mesh: trimesh.Trimesh) -> Geometry:
    """The mesh with its vertices split along sharp edges, so that a browser's smooth shading keeps them."""
    shaded = cast(trimesh.Trimesh, cast(Any, trimesh.graph).smooth_shade(mesh, angle=CREASE_RAD))
    return Geometry(np.asarray(shaded.vertices), np.asarray(shaded.faces))


def thinned(mesh: trimesh.Trimesh, cell_m: float) -> trimesh.Trimesh:
    """The mesh with all vertices of a cubic cell merged into their mean, and what then is no triangle dropped.

    Vertex clustering of Rossignac and Borrel (1993): no vertex moves more than the cell's diagonal.
    """
    cells = np.round(mesh.vertices / cell_m).astype(np.int64)
    _, index, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    index = index.reshape(-1)
    vertices = np.zeros((len(counts), 3))
    np.add.at(vertices, index, mesh.vertices)
    faces = index[mesh.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return trimesh.Trimesh(vertices / counts[:, None], faces[np.sort(first)], process=False)


def box(size_m: tuple[float, float, float], center_m: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Geometry:
    """A box with faces of its own, so that it is shaded flat."""
    mesh = trimesh.creation.box(extents=size_m)
    mesh.unmerge_vertices()
    return Geometry(np.asarray(mesh.vertices) + np.array(center_m), np.asarray(mesh.faces))


def ring(inner_m: float, outer_m: float, z_m: float, segments: int = 96) -> Geometry:
    """A flat ring around the z axis, seen from above."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    unit = np.stack([np.cos(angles), np.sin(angles), np.zeros(segments)], axis=1)
    vertices = np.concatenate([inner_m * unit, outer_m * unit]) + np.array([0.0, 0.0, z_m])
    i, j = np.arange(segments), (np.arange(segments) + 1) % segments
    lower = np.stack([i, i + segments, j], axis=1)
    upper = np.stack([j, i + segments, j + segments], axis=1)
    return Geometry(vertices, np.concatenate([lower, upper]))


def ribbon(path_m: Array, width_m: float, drop_m: float) -> Geometry:
    """A horizontal band along ``path_m`` (n, 3), ``drop_m`` below it; where it bends sharply it does not lie double."""
    side = _sideways(path_m) * (width_m / 2)
    down = np.array([0.0, 0.0, -drop_m])
    edges = [_without_loops(edge, 2.0 * width_m) for edge in (path_m + side, path_m - side)]
    vertices = np.concatenate(edges) + down
    n = len(path_m)
    i = np.arange(n - 1)
    left = np.stack([i, i + n, i + 1], axis=1)
    right = np.stack([i + 1, i + n, i + n + 1], axis=1)
    return Geometry(vertices, np.concatenate([left, right]))


def chevrons(path_m: Array, spacing_m: float, size_m: float, lift_m: float) -> Array:
    """(k, 2, 3) strokes of arrow heads along ``path_m`` (n, 3), pointing along it."""
    steps = np.linalg.norm(np.diff(path_m, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    marks = np.arange(spacing_m / 2, way[-1], spacing_m)
    tips = np.stack([np.interp(marks, way, path_m[:, k]) for k in range(3)], axis=1)
    index = np.clip(np.searchsorted(way, marks) - 1, 0, len(path_m) - 2)
    ahead = np.diff(path_m, axis=0)[index] / np.maximum(steps[index], 1e-9)[:, None]
    side = _sideways(path_m)[index]
    tips = tips + np.array([0.0, 0.0, lift_m])
    strokes = [np.stack([tips, tips - size_m * ahead + sign * size_m * side], axis=1) for sign in (1.0, -1.0)]
    return np.concatenate(strokes)


def segments(points_m: Array) -> Array:
    """(n - 1, 2, 3) strokes that join (n, 3) points; a single point gives one stroke without length."""
    if len(points_m) < 2:
        points_m = np.repeat(points_m, 2, axis=0)
    return np.stack([points_m[:-1], points_m[1:]], axis=1)


def _without_loops(edge_m: Array, longest_m: float) -> Array:
    """(n, 3) the same edge; a loop of it of up to ``longest_m`` is drawn together to where the edge crosses itself."""
    ends, steps = edge_m[:, :2], np.diff(edge_m[:, :2], axis=0)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    between = ends[None, :-1] - ends[:-1, None]
    turn = _cross(steps[:, None], steps[None])
    safe = np.where(np.abs(turn) < 1e-15, np.inf, turn)
    along_first = _cross(between, steps[None]) / safe
    along_second = _cross(between, steps[:, None]) / safe
    crossing = (along_first >= 0.0) & (along_first < 1.0) & (along_second >= 0.0) & (along_second < 1.0)
    far_on = np.arange(len(steps))[None] - np.arange(len(steps))[:, None]
    crossing &= (far_on > 1) & (way[None, 1:] - way[:-1, None] <= longest_m) & (np.abs(turn) >= 1e-15)
    out, done = edge_m.copy(), -1
    for i, j in sorted(np.argwhere(crossing).tolist(), key=lambda pair: (pair[0], -pair[1])):
        if i > done:
            out[i + 1 : j + 1] = edge_m[i] + along_first[i, j] * (edge_m[i + 1] - edge_m[i])
            done = j
    return out


def _cross(a: Array, b: Array) -> Array:
    """Of plane vectors (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _sideways(path_m: Array) -> Array:
    """(n, 3) horizontal unit vectors to the left of the path."""
    ahead = np.gradient(path_m, axis=0)
    side = np.stack([-ahead[:, 1], ahead[:, 0], np.zeros(len(ahead))], axis=1)
    return side / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
