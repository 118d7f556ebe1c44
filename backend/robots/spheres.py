"""Spheres that cover a link: the surface in clusters, each cluster in its smallest ball."""

from __future__ import annotations

import numpy as np
from scipy.cluster.vq import kmeans2

from backend.pose import Array

SLACK_M = 5e-4
"""Added to every radius, for the surface between the sampled points."""
TRIES = 3
CLUSTERED_POINTS = 800


def cover(points: Array, count: int, rng: np.random.Generator) -> Array:
    """(<= count, 4) spheres x, y, z, radius that hold all surface points (n, 3); of several tries the one with the
    least total volume."""
    few = points if len(points) <= CLUSTERED_POINTS else rng.choice(points, CLUSTERED_POINTS, replace=False)
    tries = [_cluster(few, count, rng) for _ in range(TRIES if count > 1 else 1)]
    best = min(tries, key=lambda spheres: float((spheres[:, 3] ** 3).sum()))
    return _grown(best, points)


def _cluster(points: Array, count: int, rng: np.random.Generator) -> Array:
    centers, labels = kmeans2(points, count, minit="++", rng=rng)
    spheres = np.column_stack([centers, np.zeros(count)])
    for _ in range(10):
        spheres = np.array([smallest_ball(points[labels == k]) for k in np.unique(labels)])
        gaps = np.linalg.norm(points[:, None] - spheres[None, :, :3], axis=2) - spheres[:, 3]
        labels = np.argmin(gaps, axis=1)
    return np.array([smallest_ball(points[labels == k]) for k in np.unique(labels)])


def _grown(spheres: Array, points: Array) -> Array:
    """The spheres, each just large enough that together they hold all points (n, 3)."""
    distance = np.linalg.norm(points[:, None] - spheres[None, :, :3], axis=2)
    nearest = np.argmin(distance - spheres[:, 3], axis=1)
    held = [distance[nearest == k, k].max(initial=0.0) + SLACK_M for k in range(len(spheres))]
    return np.column_stack([spheres[:, :3], held])


def smallest_ball(points: Array) -> Array:
    """(4,) x, y, z, radius of nearly the smallest ball around points (n, 3) (Badoiu and Clarkson 2003)."""
    center = points.mean(axis=0)
    for i in range(1, 120):
        furthest = points[np.argmax(((points - center) ** 2).sum(axis=1))]
        center = center + (furthest - center) / (i + 1)
    return np.append(center, np.linalg.norm(points - center, axis=1).max())
