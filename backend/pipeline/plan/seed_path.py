"""Seed path: the part of the previous path that still holds, and how the new goal is reached from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
from backend.pipeline.plan.ends import Ends
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

SAME_RAD = 1e-6
MOST_SEED_STATES = 24
SEED_SPACING_RAD = 0.3


@dataclass(frozen=True, eq=False)
class Found:
    """A path before it is dressed up as a plan."""

    waypoints: Array
    goal_index: int
    how: str


class CheckCount:
    """Counts the state checks of one plan."""

    def __init__(self, scene: PlanningScene) -> None:
        self.scene = scene
        self.checks = 0

    def edge_free(self, q0: Array, q1: Array) -> bool:
        """Whether the edge from free ``q0`` to ``q1`` is free."""
        cost = self.scene.edge_checks(q0, q1)
        self.checks += abs(cost)
        return cost > 0

    def is_free(self, q: Array) -> bool:
        self.checks += 1
        return self.scene.is_free(q)


def straight(ends: Ends, count: CheckCount) -> Found | None:
    """One straight edge to the first goal that can be reached so."""
    for index, goal in ends.goals:
        if count.edge_free(ends.start, goal):
            return Found(np.vstack([ends.lead, goal]), index, "straight")
    return None


def valid_chain(ends: Ends, seed: Path | None, count: CheckCount) -> Array:
    """(n, dof) the start and the waypoints of the previous path that still follow from it validly."""
    chain = [ends.start]
    for waypoint in ahead(ends, seed):
        if not count.edge_free(chain[-1], waypoint):
            break
        chain.append(waypoint)
    return np.array(chain)


def ahead(ends: Ends, seed: Path | None) -> Array:
    """(n, dof) the waypoints of the previous path after its point nearest to the start; none without such a path."""
    none = np.zeros((0, ends.start.size))
    if seed is None or seed.waypoints.ndim != 2 or seed.waypoints.shape[1:] != none.shape[1:]:
        return none
    if len(seed.waypoints) == 0 or not np.isfinite(seed.waypoints).all():
        return none
    return _ahead(seed.waypoints, ends.start)


def reconnected(ends: Ends, chain: Array, count: CheckCount) -> Found | None:
    """Along the previous path as far as possible, then straight to a goal.

    Its end is where the goal was before, so the corner before that is tried first: otherwise every cycle would add
    a waypoint.
    """
    last_first = range(len(chain) - 1, 0, -1)
    for last in sorted(last_first, key=lambda i: i != len(chain) - 2):
        for index, goal in ends.goals:
            if count.edge_free(chain[last], goal):
                return Found(np.vstack([ends.lead, chain[1 : last + 1], goal]), index, "reconnected")
    return None


def without_repeats(waypoints: Array) -> Array:
    """The same path without waypoints that equal their predecessor; its ends stay exact."""
    if len(waypoints) < 2:
        return waypoints
    kept = _kept(np.ascontiguousarray(waypoints))
    return waypoints if len(kept) == len(waypoints) else waypoints[kept]


def along(chain: Array) -> tuple[Array, list[int]]:
    """(n, dof) evenly spread states along a chain of waypoints, and for each the waypoint at or before it."""
    length = float(np.linalg.norm(np.diff(chain, axis=0), axis=1).sum())
    spacing = max(SEED_SPACING_RAD, length / MOST_SEED_STATES)
    states, before = [chain[0]], [0]
    for i in range(len(chain) - 1):
        edge = chain[i + 1] - chain[i]
        pieces = max(1, int(np.linalg.norm(edge) / spacing))
        states.extend(chain[i] + edge * (k / pieces) for k in range(1, pieces + 1))
        before.extend([*([i] * (pieces - 1)), i + 1])
    return np.array(states), before


def _ahead(waypoints: Array, q: Array) -> Array:
    """The waypoints after the point of the path nearest to ``q``."""
    return waypoints[_first_ahead(np.ascontiguousarray(waypoints), q) :]


@kernel
def _first_ahead(waypoints: Array, q: Array) -> int:
    """Index of the first waypoint after the point of the path nearest to ``q`` that is not at ``q``."""
    if waypoints.shape[0] == 1:
        return 0
    nearest, first = np.inf, 0
    for i in range(waypoints.shape[0] - 1):
        edge, to_q = waypoints[i + 1] - waypoints[i], q - waypoints[i]
        share = min(max(np.sum(to_q * edge) / max(np.sum(edge * edge), SAME_RAD**2), 0.0), 1.0)
        gap = np.sum((share * edge - to_q) ** 2)
        if gap < nearest:
            nearest, first = gap, i + 1
    return first + 1 if np.max(np.abs(waypoints[first] - q)) < SAME_RAD else first


@kernel
def _kept(waypoints: Array) -> NDArray[np.int64]:
    """Indices of the waypoints that do not equal the one kept before; the last is always among them."""
    kept, n = np.zeros(len(waypoints), dtype=np.int64), 1
    for i in range(1, len(waypoints)):
        if np.max(np.abs(waypoints[i] - waypoints[kept[n - 1]])) > SAME_RAD:
            kept[n] = i
            n += 1
    kept[n - 1] = len(waypoints) - 1
    return kept[:n]
