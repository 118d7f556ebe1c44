"""Compiled shortcuts: a found path made shorter by straight edges (Geraerts and Overmars 2007), and checked again."""

from __future__ import annotations

import numpy as np

from backend.kinematics.compiled import kernel
from backend.pipeline.plan.edges import SceneArrays, edge_cost, edges_free
from backend.pose import Array

ATTEMPTS = 40
LEAST_GAIN_RAD = 1e-3


@kernel
def skipped(scene: SceneArrays, path: Array) -> tuple[Array, int]:
    """The path (n, dof), from each waypoint straight to the farthest one that can be reached; state checks."""
    kept = np.empty_like(path)
    kept[0] = path[0]
    count, here, checks = 1, 0, 0
    while here < path.shape[0] - 1:
        there = path.shape[0] - 1
        while there > here + 1:
            cost = edge_cost(scene, path[here], path[there])
            checks += abs(cost)
            if cost > 0:
                break
            there -= 1
        kept[count] = path[there]
        count += 1
        here = there
    return kept[:count].copy(), checks


@kernel
def distance(a: Array, b: Array) -> float:
    """Euclidean, in rad."""
    square = 0.0
    for j in range(a.shape[0]):
        square += (a[j] - b[j]) ** 2
    return np.sqrt(square)


@kernel
def point_at(path: Array, way: float, q: Array) -> int:
    """Fill ``q`` with the point of the path (n, dof) after ``way`` rad along it; the row at or before it."""
    last = path.shape[0] - 2
    for i in range(last + 1):
        length = distance(path[i], path[i + 1])
        if way <= length or i == last:
            share = min(1.0, way / max(length, 1e-12))
            for j in range(q.shape[0]):
                q[j] = path[i, j] + share * (path[i + 1, j] - path[i, j])
            return i
        way -= length
    return last


@kernel
def cut(scene: SceneArrays, path: Array, rng: np.random.Generator) -> tuple[Array, int]:
    """The path with corners cut between random points; state checks."""
    a, b = np.empty(path.shape[1]), np.empty(path.shape[1])
    checks = 0
    for _ in range(ATTEMPTS):
        if path.shape[0] == 2:
            break
        length = 0.0
        for i in range(path.shape[0] - 1):
            length += distance(path[i], path[i + 1])
        one, other = length * rng.random(), length * rng.random()
        i, k = point_at(path, min(one, other), a), point_at(path, max(one, other), b)
        if i == k or abs(other - one) - distance(a, b) < LEAST_GAIN_RAD:
            continue
        cost = edge_cost(scene, a, b)
        checks += abs(cost)
        if cost > 0:
            shorter = np.empty((path.shape[0] - (k - i) + 2, path.shape[1]))
            shorter[: i + 1], shorter[i + 1], shorter[i + 2], shorter[i + 3 :] = path[: i + 1], a, b, path[k + 1 :]
            path = shorter
    return path, checks


@kernel
def shortened(scene: SceneArrays, path: Array, rng: np.random.Generator) -> tuple[Array, int]:
    """A shorter path with the same ends, every edge of it found free as it stands; no rows when that fails.

    Two halves of an edge are checked at other postures than the whole, so what was cut is checked once more.
    """
    straight, checks = skipped(scene, path)
    curved, cost = cut(scene, straight, rng)
    checks += cost
    for candidate in (curved, straight, path):
        cost = edges_free(scene, candidate)
        checks += abs(cost)
        if cost >= 0:
            return candidate, checks
    return path[:0].copy(), checks
