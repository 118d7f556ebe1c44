"""Lofts: closed surfaces through measured horizontal super-elliptic sections, and convex pieces of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from backend.objects.mesh import Mesh
from backend.pose import Array


@dataclass(frozen=True)
class Section:
    """``|(x - shift) / half_x|^exponent + |y / half_y|^exponent = 1`` at one height."""

    z_m: float
    half_x_m: float
    half_y_m: float
    exponent: float = 2.0
    shift_m: float = 0.0
    """Offset of the section's middle along x."""


def sections_mm(*rows: tuple[float, ...]) -> tuple[Section, ...]:
    """Sections of rows ``(z, half_x, half_y[, exponent[, shift]])`` in millimetres."""
    return tuple(_section_mm(*row) for row in rows)


def loft(sections: Sequence[Section], points: int = 64, rings_per_row: int = 3) -> Mesh:
    """Watertight surface through ``sections`` (bottom to top), closed flat at both ends.

    Between the sections their numbers run along monotone cubics, so the surface is smooth and stays between
    its neighbours; ``points`` (a multiple of 4) on each ring.
    """
    rings = [ring(section, points) for section in _refined(sections, rings_per_row)]
    low, high = rings[0].mean(axis=0), rings[-1].mean(axis=0)
    vertices = np.concatenate([*rings, [low, high]])
    return Mesh(vertices, _tube_faces(len(rings), points))


def convex_bands(sections: Sequence[Section], splits_m: Sequence[float] = (), points: int = 32) -> tuple[Mesh, ...]:
    """Convex hulls of the pieces of a loft between the heights ``splits_m``, bottom to top."""
    edges = [sections[0].z_m, *splits_m, sections[-1].z_m]
    return tuple(_band(sections, low, high, points) for low, high in pairwise(edges))


def ring(section: Section, points: int) -> Array:
    """(points, 3) counter-clockwise around a section, from +x on, evenly spaced within each quadrant."""
    quarter = _quarter(section, points // 4)
    half = np.concatenate([quarter, quarter[-2:0:-1] * (-1, 1)])
    outline = np.concatenate([half, -half])
    return np.column_stack([outline[:, 0] + section.shift_m, outline[:, 1], np.full(points, section.z_m)])


def interpolated(sections: Sequence[Section], z_m: Array) -> list[Section]:
    """Sections at any heights within the loft, on the monotone cubics that ``loft`` follows."""
    table = np.array([[getattr(s, field.name) for field in fields(Section)] for s in sections])
    return [Section(*row.tolist()) for row in _along(table, z_m)]


def convex_hull(points: Array) -> Mesh:
    """Convex watertight mesh around (n, 3) ``points``, its faces counter-clockwise seen from outside."""
    from scipy.spatial import ConvexHull  # slow to import, and only needed when an object is made

    hull = ConvexHull(points)
    used, flat = np.unique(hull.simplices, return_inverse=True)
    faces = flat.reshape(-1, 3)
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(points[used], faces)


def _section_mm(z: float, half_x: float, half_y: float, exponent: float = 2.0, shift: float = 0.0) -> Section:
    return Section(z / 1000, half_x / 1000, half_y / 1000, exponent, shift / 1000)


def _along(table: Array, z_m: Array) -> Array:
    """(n, 5) rows at heights ``z_m`` of a (rows, 5) table whose first column is the height."""
    if len(table) == 2:
        u = (z_m - table[0, 0])[:, None] / (table[1, 0] - table[0, 0])
        return table[0] + u * (table[1] - table[0])
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(table[:, 0], table)(z_m), dtype=np.float64)


def _refined(sections: Sequence[Section], rings_per_row: int) -> list[Section]:
    z_m = np.array([s.z_m for s in sections])
    steps = np.linspace(0.0, 1.0, rings_per_row, endpoint=False)
    between = (z_m[:-1, None] + np.diff(z_m)[:, None] * steps).ravel()
    return interpolated(sections, np.append(between, z_m[-1]))


def _band(sections: Sequence[Section], low_m: float, high_m: float, points: int) -> Mesh:
    inside = [s for s in sections if low_m < s.z_m < high_m]
    low, high = interpolated(sections, np.array([low_m, high_m]))
    return convex_hull(np.concatenate([ring(s, points) for s in (low, *inside, high)]))


def _quarter(section: Section, steps: int) -> Array:
    """(steps + 1, 2) from (half_x, 0) to (0, half_y), evenly spaced by arc length."""
    angle = np.linspace(0.0, np.pi / 2, 8 * steps + 1)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    direction[-1, 0] = 0.0
    scaled = direction / (section.half_x_m, section.half_y_m)
    dense = direction / (scaled**section.exponent).sum(axis=1, keepdims=True) ** (1 / section.exponent)
    arc = np.append(0.0, np.linalg.norm(np.diff(dense, axis=0), axis=1).cumsum())
    wanted = np.linspace(0.0, arc[-1], steps + 1)
    return np.stack([np.interp(wanted, arc, dense[:, axis]) for axis in (0, 1)], axis=1)


def _tube_faces(rings: int, points: int) -> NDArray[np.int64]:
    """Triangles of a stack of rings and of the fans that close it around the last two vertices."""
    here = np.arange(points)
    after = (here + 1) % points
    start = (np.arange(rings - 1) * points)[:, None]
    lower = np.stack([start + here, start + after, start + after + points], axis=-1)
    upper = np.stack([start + here, start + after + points, start + here + points], axis=-1)
    bottom, top = rings * points, rings * points + 1
    last = (rings - 1) * points
    low_fan = np.stack([np.full(points, bottom), after, here], axis=-1)
    high_fan = np.stack([np.full(points, top), last + here, last + after], axis=-1)
    return np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3), low_fan, high_fan])
