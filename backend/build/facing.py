"""Facing: where two sides of an object lie opposite each other within a hand's opening."""

import numpy as np
import trimesh

from backend.objects import ObjectDescription

FACING = float(np.cos(np.radians(20.0)))
"""Least cosine between the line that joins two points and both surface normals."""
POINTS = 1200
CLEARANCE_M = 0.008
"""The open hand is at least this much wider than what it closes on."""
THINNEST_M = 0.01


def facing_pairs(target: ObjectDescription, opening_m: float, seed: int) -> int:
    """Of ``POINTS`` random surface points, how many pairs a hand that opens so wide could close on."""
    sampled = trimesh.sample.sample_surface(target.visual.as_trimesh(), POINTS, seed=seed)
    points, normals = np.asarray(sampled[0]), target.visual.face_normals[np.asarray(sampled[1])]
    between = points[None] - points[:, None]
    width = np.linalg.norm(between, axis=2)
    np.fill_diagonal(width, np.inf)
    direction = between / width[..., None]
    outwards_i = -np.einsum("ijk,ik->ij", direction, normals)
    outwards_j = np.einsum("ijk,jk->ij", direction, normals)
    fits = (width > THINNEST_M) & (width < opening_m - CLEARANCE_M) & (outwards_i > FACING) & (outwards_j > FACING)
    return int(np.triu(fits, 1).sum())
