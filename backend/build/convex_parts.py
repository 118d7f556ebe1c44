"""Cuts a body into convex parts (CoACD: Wei et al., ACM TOG 41(4), 2022, doi:10.1145/3528223.3530103)."""

from __future__ import annotations

from typing import Any, cast

import coacd
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import QhullError

from backend.directions import fibonacci_sphere
from backend.objects.loft import convex_hull
from backend.objects.mesh import Mesh
from backend.pose import Array

SEARCH = {"mcts_iterations": 60, "mcts_nodes": 15}
"""A third of the default search: the same parts within a percent of volume."""
SLIVER = 1e-4
"""A part with less than this share of the body's volume is left out."""
DIRECTIONS = 250
RIM_DIRECTIONS, RIM_SLOPE = 48, 1e-3
SAMPLES = 200_000


def cut_into_parts(body: Mesh, most: int, concavity: float, seed: int) -> list[Array]:
    """Corners (n, 3) of at most ``most`` convex parts, in the body's frame. Same arguments, same parts.

    ``concavity`` is how far, in units of half the body's size, the surface may lie below a part's hull.
    """
    _coacd = cast(Any, coacd)
    _coacd.set_log_level("error")
    parts = _coacd.run_coacd(
        _coacd.Mesh(body.vertices, body.faces),
        threshold=concavity,
        max_convex_hull=most,
        preprocess_mode="off",
        seed=seed,
        **SEARCH,
    )
    return [np.asarray(vertices, dtype=np.float64) for vertices, _ in parts]


def closed_parts(corners: list[Array], visual: Mesh) -> tuple[Mesh, ...]:
    """Convex closed meshes around the corners (n, 3) of each part, all in the object frame of ``visual``.

    Parts stay within the body's bounds. Of a round part only corners in evenly spread directions are kept, and the rim
    of what it stands on. Slivers are left out.
    """
    low, high = visual.bounds_m
    parts: list[Mesh] = []
    for points in corners:
        try:
            part = convex_hull(_outermost(np.clip(points, low, high)))
        except QhullError:  # flat
            continue
        if part.volume_m3 > SLIVER * visual.volume_m3:
            parts.append(part)
    return tuple(parts)


def union_volume_m3(parts: tuple[Mesh, ...], seed: int) -> float:
    """Volume of the union of convex parts, by random points; off by about half a percent."""
    corners = np.concatenate([part.vertices for part in parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    points = np.random.default_rng(seed).uniform(low, high, (SAMPLES, 3))
    inside = np.zeros(SAMPLES, dtype=np.bool_)
    for part in parts:
        near = ~inside & ((points > part.bounds_m[0]) & (points < part.bounds_m[1])).all(axis=1)
        inside[near] = _within(part, points[near])
    return float(inside.mean() * np.prod(high - low))


def _within(part: Mesh, points: Array) -> NDArray[np.bool_]:
    """(n,) whether points (n, 3) lie within a convex mesh."""
    offsets = (part.face_normals * part.triangles[:, 0]).sum(axis=1)
    within = np.ones(len(points), dtype=np.bool_)
    for normal, offset in zip(part.face_normals, offsets, strict=True):
        within[within] = points[within] @ normal <= offset
    return within


def _outermost(points: Array) -> Array:
    """Those of (n, 3) that are furthest in some direction, as many as matter."""
    if len(points) <= DIRECTIONS:
        return points
    angle = np.linspace(0.0, 2.0 * np.pi, RIM_DIRECTIONS, endpoint=False)
    rim = np.column_stack([RIM_SLOPE * np.cos(angle), RIM_SLOPE * np.sin(angle), np.full(RIM_DIRECTIONS, -1.0)])
    directions = np.concatenate([fibonacci_sphere(DIRECTIONS), np.eye(3), -np.eye(3), rim])
    return points[np.unique((directions @ points.T).argmax(axis=1))]
