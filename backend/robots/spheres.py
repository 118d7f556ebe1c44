"""Spheres that cover a link: balls inside its convex pieces, grown by an excess, chosen greedily."""

from __future__ import annotations

import numpy as np

from backend.pose import Array
from backend.robots.shapes import ConvexPiece

CANDIDATES = 2000
"""Places inside a link where a sphere may be put."""
COVERED_POINTS = 2500
SLACK_M = 3e-4
"""Kept between a covered point and its sphere's surface, for the surface between the sampled points."""


def cover(points: Array, pieces: list[ConvexPiece], excess_m: float, rng: np.random.Generator) -> Array:
    """(n, 4) spheres x, y, z, radius that hold all surface points (n, 3).

    Every sphere is the largest ball at its centre inside one of the convex ``pieces``, grown by ``excess_m``: so
    none sticks out of the link's collision shape by more. The sphere that holds most of what is still uncovered
    comes next (greedy set cover), then each shrinks to what it must hold.
    """
    some = points if len(points) <= COVERED_POINTS else rng.choice(points, COVERED_POINTS, replace=False)
    centers, depth = _places(pieces, rng)
    extra = some[rng.permutation(len(some))[: CANDIDATES // 4]]
    centers, depth = np.vstack([centers, extra]), np.append(depth, np.zeros(len(extra)))
    distance = np.linalg.norm(some[:, None] - centers[None], axis=2)
    holds = distance <= depth + excess_m - SLACK_M
    chosen: list[int] = []
    left = np.ones(len(some), dtype=np.bool_)
    while left.any():
        gains = holds[left].sum(axis=0)
        best = int(np.argmax(gains))
        if gains[best] == 0:
            break
        chosen.append(best)
        left &= ~holds[:, best]
    spheres = np.column_stack([centers[chosen], depth[chosen] + excess_m])
    return _fitted(spheres, points)


def _places(pieces: list[ConvexPiece], rng: np.random.Generator) -> tuple[Array, Array]:
    """(n, 3) random points inside the pieces, and (n,) how deep inside one of them each lies."""
    sizes = np.array([np.prod(np.ptp(piece.vertices, axis=0)) for piece in pieces])
    counts = np.ceil(CANDIDATES * sizes / sizes.sum()).astype(int)
    centers: list[Array] = []
    for piece, count in zip(pieces, counts, strict=True):
        weights = rng.dirichlet(np.full(len(piece.vertices), 0.15), int(count))
        inside = np.vstack([weights @ piece.vertices, _spine(piece, int(count) // 4)])
        centers.append(inside)
    places = np.vstack(centers)
    depth = np.max([piece.depth_m(places) for piece in pieces], axis=0)
    return places, np.maximum(depth, 0.0)


def _spine(piece: ConvexPiece, count: int) -> Array:
    """(count, 3) points along the piece's longest axis through its middle, where the deepest places are."""
    middle = piece.vertices.mean(axis=0)
    axis = np.linalg.svd(piece.vertices - middle, full_matrices=False)[2][0]
    reach = (piece.vertices - middle) @ axis
    return middle + np.linspace(reach.min(), reach.max(), max(count, 2))[:, None] * axis


def _fitted(spheres: Array, points: Array) -> Array:
    """The spheres just large enough that together they hold all points (n, 3); useless ones are left out."""
    distance = np.linalg.norm(points[:, None] - spheres[None, :, :3], axis=2)
    nearest = np.argmin(distance - spheres[:, 3], axis=1)
    held = np.array([distance[nearest == k, k].max(initial=0.0) for k in range(len(spheres))])
    return np.column_stack([spheres[:, :3], held + SLACK_M])[held > 0.0]
