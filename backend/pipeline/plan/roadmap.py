"""Roadmap: which postures are joined by free edges, and the way between two of them."""

from __future__ import annotations

from collections import deque

import numpy as np

from backend.pose import Array


class Roadmap:
    """An undirected graph of postures (dof,); a posture is known by its exact angles."""

    def __init__(self) -> None:
        self._parents: dict[bytes, bytes] = {}
        self._neighbours: dict[bytes, list[bytes]] = {}

    def join(self, q0: Array, q1: Array) -> None:
        """Add the edge between two postures, known already or not."""
        a, b = _name(q0), _name(q1)
        self._neighbours.setdefault(a, []).append(b)
        self._neighbours.setdefault(b, []).append(a)
        self._parents[self._root(a)] = self._root(b)

    def joined(self, q0: Array, q1: Array) -> bool:
        """Whether edges lead from one posture to the other."""
        return self._root(_name(q0)) == self._root(_name(q1))

    def way(self, q0: Array, q1: Array) -> Array | None:
        """(n, dof) a way with the fewest edges, both ends included; None when there is none."""
        start, goal = _name(q0), _name(q1)
        came_from = {start: start}
        queue = deque([start])
        while queue and goal not in came_from:
            here = queue.popleft()
            for there in self._neighbours.get(here, ()):
                if there not in came_from:
                    came_from[there] = here
                    queue.append(there)
        return _way_back(came_from, goal) if goal in came_from else None

    def _root(self, node: bytes) -> bytes:
        """The node that stands for all that are joined with this one."""
        parents = self._parents
        while (parent := parents.setdefault(node, node)) != node:
            parents[node] = parents[parent]
            node = parents[node]
        return node


def _name(q: Array) -> bytes:
    return np.asarray(q, dtype=np.float64).tobytes()


def _way_back(came_from: dict[bytes, bytes], goal: bytes) -> Array:
    way = [goal]
    while came_from[way[-1]] != way[-1]:
        way.append(came_from[way[-1]])
    return np.array([np.frombuffer(node) for node in reversed(way)])
