"""A tree of spheres around spheres, so that most of a link is ruled out by one look at a large sphere.

Nodes lie in depth-first order; each knows where to go on when its whole subtree is ruled out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
from backend.pose import Array

Integers = NDArray[np.int64]


@kernel
def enclose(spheres: Array, members: Integers, out: Array) -> None:
    """A sphere around some spheres: the middle of their box, moved toward the farthest in shrinking steps."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for m in members:
        for k in range(3):
            low[k] = min(low[k], spheres[m, k] - spheres[m, 3])
            high[k] = max(high[k], spheres[m, k] + spheres[m, 3])
    center = 0.5 * (low + high)
    for step in range(60):
        reach, farthest = -1.0, 0
        for m in members:
            distance = spheres[m, 3]
            distance += np.sqrt(np.sum((spheres[m, :3] - center) ** 2))
            if distance > reach:
                reach, farthest = distance, m
        out[:3] = center
        out[3] = reach
        if members.shape[0] == 1:
            return
        if step < 59:
            center = center + (spheres[farthest, :3] - center) / (step + 10.0)


@kernel
def grow(spheres: Array, nodes: Array, skips: Integers) -> None:
    """Fill ``nodes`` (2n - 1, 4) and, counted from the first of them, ``skips``: -1 marks a leaf."""
    n = spheres.shape[0]
    order = np.arange(n)
    stack = np.empty((2 * n, 3), dtype=np.int64)
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, n, 0
    top = 1
    while top > 0:
        top -= 1
        start, stop, node = stack[top, 0], stack[top, 1], stack[top, 2]
        members = order[start:stop].copy()
        enclose(spheres, members, nodes[node])
        count = stop - start
        skips[node] = node + 2 * count - 1
        if count == 1:
            nodes[node] = spheres[members[0]]
            skips[node] = -1
            continue
        axis, widest = 0, -1.0
        for k in range(3):
            values = spheres[members, k]
            if values.max() - values.min() > widest:
                axis, widest = k, values.max() - values.min()
        order[start:stop] = members[np.argsort(spheres[members, axis], kind="mergesort")]
        middle = start + count // 2
        stack[top, 0], stack[top, 1], stack[top, 2] = start, middle, node + 1
        stack[top + 1, 0], stack[top + 1, 1] = middle, stop
        stack[top + 1, 2] = node + 2 * (middle - start)
        top += 2


def sphere_tree(spheres: Array) -> tuple[Array, Integers]:
    """((2n - 1, 4) nodes, (2n - 1,) skips relative to the first node, -1 at leaves) of (n, 4) spheres."""
    count = 2 * len(spheres) - 1
    nodes, skips = np.empty((count, 4)), np.empty(count, dtype=np.int64)
    grow(np.ascontiguousarray(spheres), nodes, skips)
    return nodes, skips
