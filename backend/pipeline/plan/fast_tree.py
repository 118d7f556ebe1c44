"""Compiled RRT-Connect (Kuffner and LaValle 2000) whose two trees may begin as chains of postures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
from backend.pipeline.plan.edges import SceneArrays, edge_cost
from backend.pose import Array

Integers = NDArray[np.int64]
Roots = tuple[Array, Integers]
"""Nodes (n, dof) that a tree begins with, and the row of each one's parent (n,), -1 where it has none."""
Sampling = tuple[Array, Array, float]
"""Box (2, dof) of all samples; centres (n, dof); share of the samples that are drawn around these."""

RANGE_RAD = 1.0
"""Longest edge the trees grow by."""
NEAR_RAD = 1.0
"""How far from a centre at most, in each joint; nearer ones are likelier."""
MOST_NODES = 4096
"""Of either tree. A search ends when one is full."""


@kernel
def draw(sampling: Sampling, rng: np.random.Generator, q: Array) -> None:
    """Fill ``q`` (dof,) with a posture of the box."""
    box, centres, share = sampling
    near = centres.shape[0] > 0 and rng.random() < share
    centre = centres[rng.integers(0, centres.shape[0])] if near else q
    scale = NEAR_RAD * rng.random() if near else 0.0
    for j in range(q.shape[0]):
        if near:
            q[j] = min(max(centre[j] + scale * (2.0 * rng.random() - 1.0), box[0, j]), box[1, j])
        else:
            q[j] = box[0, j] + rng.random() * (box[1, j] - box[0, j])


@kernel
def nearest(nodes: Array, q: Array) -> tuple[int, float]:
    """Row of ``nodes`` (n, dof) nearest to ``q``, and its distance in rad."""
    best, least = 0, np.inf
    for i in range(nodes.shape[0]):
        square = 0.0
        for j in range(q.shape[0]):
            square += (nodes[i, j] - q[j]) ** 2
        if square < least:
            best, least = i, square
    return best, np.sqrt(least)


@kernel
def way_from_root(nodes: Array, parents: Integers, node: int) -> Array:
    """(k, dof) from a root to ``node``."""
    length, at = 1, node
    while parents[at] >= 0:
        at = parents[at]
        length += 1
    way = np.empty((length, nodes.shape[1]))
    at = node
    for k in range(length - 1, -1, -1):
        way[k] = nodes[at]
        at = parents[at]
    return way


@kernel
def grow(
    scene: SceneArrays, starts: Roots, goals: Roots, sampling: Sampling, rng: np.random.Generator, max_checks: int
) -> tuple[Array, int]:
    """Grow trees from free ``starts`` and ``goals`` until they meet, checks run out or a tree is full.

    Gives (k, dof) from a root of the starts to one of the goals, no rows when they did not meet, and the state checks.
    """
    dof = starts[0].shape[1]
    nodes, parents = np.empty((2, MOST_NODES, dof)), np.empty((2, MOST_NODES), dtype=np.int64)
    counts = np.array([min(starts[0].shape[0], MOST_NODES), min(goals[0].shape[0], MOST_NODES)])
    nodes[0, : counts[0]], parents[0, : counts[0]] = starts[0][: counts[0]], starts[1][: counts[0]]
    nodes[1, : counts[1]], parents[1, : counts[1]] = goals[0][: counts[1]], goals[1][: counts[1]]
    sample, step = np.empty(dof), np.empty(dof)
    checks, here = 0, 0
    while checks < max_checks and max(counts[0], counts[1]) < MOST_NODES:
        draw(sampling, rng, sample)
        target, growing = sample, here
        while max(counts[0], counts[1]) < MOST_NODES:
            near, distance = nearest(nodes[growing, : counts[growing]], target)
            share = min(1.0, RANGE_RAD / max(distance, 1e-12))
            for j in range(dof):
                step[j] = nodes[growing, near, j] + share * (target[j] - nodes[growing, near, j])
            arrives = growing != here and share == 1.0
            if arrives:
                step[:] = target
            cost = edge_cost(scene, nodes[growing, near], step)
            checks += abs(cost)
            if cost < 0:
                break
            new = counts[growing]
            nodes[growing, new], parents[growing, new] = step, near
            counts[growing] += 1
            if arrives:
                from_start = way_from_root(nodes[0], parents[0], counts[0] - 1)
                from_goal = way_from_root(nodes[1], parents[1], counts[1] - 1)
                return np.concatenate((from_start[:-1], from_goal[::-1])), checks
            if growing == here:
                growing = 1 - here
                target = nodes[here, new]
        here = 1 - here
    return np.empty((0, dof)), checks
