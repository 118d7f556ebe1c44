"""CHOMP's descent: covariant steps down smoothness and obstacle cost, ends fixed, within joint limits."""

from __future__ import annotations

from functools import cache

import numpy as np

from backend.kinematics.compiled import kernel
from backend.pipeline.plan.chomp_cost import obstacle_cost
from backend.pipeline.plan.edges import SceneArrays, edges_free
from backend.pose import Array

STEP_RAD = 0.12
"""No joint of any waypoint moves more in one step."""
RATE = 0.02
"""Share of its way back to the straight line that a path goes in one step when nothing is near."""
LIMIT_ROUNDS = 4
"""Smooth projections into the joint limits before what is left is cut off."""


@cache
def root_of_metric(count: int) -> Array:
    """(count, count) K^-1, where K are second differences of ``count`` waypoints between two fixed ends.

    Scaled to accelerations of a path passed in unit time, so that sum_i |K q|_i^2 is their integral.
    """
    differences = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    return np.linalg.inv(differences * (count + 1.0) ** 1.5)


@cache
def inverse_metric(count: int) -> Array:
    """(count, count) A^-1, where A = K^T K is the metric in which a step is measured (section III-A)."""
    root = root_of_metric(count)
    return root @ root.T


def straight_line(q0: Array, q1: Array, count: int) -> Array:
    """(count + 2, dof) evenly spaced from ``q0`` to ``q1``, both exact: the smoothest path between them."""
    return np.linspace(q0, q1, count + 2)


def bent_line(q0: Array, q1: Array, count: int, bend_rad: float, rng: np.random.Generator) -> Array:
    """As ``straight_line``, plus a smooth random bend (normal in the metric A) of ``bend_rad`` where it is largest."""
    bend = root_of_metric(count) @ rng.normal(size=(count, q0.size))
    path = straight_line(q0, q1, count)
    path[1:-1] += bend * (bend_rad / np.abs(bend).max())
    return path


@kernel
def line_along(chain: Array, goal: Array, count: int) -> Array:
    """(count + 2, dof) evenly spaced along ``chain`` (n, dof), moved so that it ends at ``goal``.

    The shift grows evenly along the path: moving an end so costs no accelerations.
    """
    n, dof = chain.shape
    marks = np.zeros(n)
    for i in range(1, n):
        marks[i] = marks[i - 1] + np.sqrt(np.sum((chain[i] - chain[i - 1]) ** 2))
    path = np.empty((count + 2, dof))
    edge = 0
    for k in range(count + 2):
        share = k / (count + 1)
        at = share * marks[-1]
        while edge < n - 2 and marks[edge + 1] < at:
            edge += 1
        part = (at - marks[edge]) / max(marks[edge + 1] - marks[edge], 1e-12)
        for j in range(dof):
            here = chain[edge, j] + part * (chain[edge + 1, j] - chain[edge, j])
            path[k, j] = here + share * (goal[j] - chain[-1, j])
    path[0], path[-1] = chain[0], goal
    return path


@kernel
def keep_within(qs: Array, limits: Array, metric: Array) -> None:
    """Move the inner waypoints (n, dof) into ``limits`` (2, dof), first smoothly, then by cutting off."""
    for j in range(qs.shape[1]):
        for _ in range(LIMIT_ROUNDS):
            beyond = qs[:, j] - np.minimum(np.maximum(qs[:, j], limits[0, j]), limits[1, j])
            worst = int(np.argmax(np.abs(beyond)))
            if beyond[worst] == 0.0:
                break
            qs[:, j] -= metric[:, worst] * (beyond[worst] / metric[worst, worst])
        qs[:, j] = np.minimum(np.maximum(qs[:, j], limits[0, j]), limits[1, j])


@kernel
def covariant_step(bend: Array, gradient: Array, metric: Array, smoothness: float) -> Array:
    """(n, dof) step against smoothness / 2 * (integral of squared accelerations) + obstacle cost, in the metric A.

    ``bend`` (n + 2, dof) is the path less the straight line between its ends, ``gradient`` the obstacle cost's.
    A^-1 times the first term's gradient is the bend itself. No entry exceeds ``STEP_RAD``.
    """
    n, dof = metric.shape[0], bend.shape[1]
    step = RATE * bend[1:-1]
    for i in range(n):
        for k in range(n):
            for j in range(dof):
                step[i, j] += RATE / smoothness * metric[i, k] * gradient[k + 1, j]
    largest = np.max(np.abs(step))
    return step * (STEP_RAD / max(largest, STEP_RAD))


@kernel
def descend(
    scene: SceneArrays, limits: Array, path: Array, metric: Array, reach: float, smoothness: float, iterations: int
) -> tuple[bool, int, int]:
    """Bend ``path`` (n + 2, dof) in place until it touches nothing: whether it does, steps taken, state checks.

    Its ends stay. ``metric`` is ``inverse_metric(n)``. The path is looked at before each step and after the last.
    """
    n = path.shape[0] - 2
    line, gradient = np.empty_like(path), np.empty_like(path)
    for i in range(n + 2):
        line[i] = path[0] + (i / (n + 1)) * (path[-1] - path[0])
    keep_within(path[1:-1], limits, metric)
    cost = edges_free(scene, path)
    checks = abs(cost)
    if cost > 0:
        return True, 0, checks
    for iteration in range(iterations + 1):
        _, least = obstacle_cost(scene, path, reach, gradient)
        checks += n
        if least >= 0.0:
            cost = edges_free(scene, path)
            checks += abs(cost)
            if cost > 0:
                return True, iteration, checks
        path[1:-1] -= covariant_step(path - line, gradient, metric, smoothness)
        keep_within(path[1:-1], limits, metric)
    return False, iterations, checks
