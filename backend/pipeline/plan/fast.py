"""``fast``: the whole ladder compiled, over all goals that were picked, from the cheapest answer to the dearest."""

from __future__ import annotations

import numpy as np

from backend.methods.method import FastLadder
from backend.pipeline.plan.edges import SceneArrays
from backend.pipeline.plan.ends import Ends, check_ends, sampled_box
from backend.pipeline.plan.fast_rungs import first_reached, still_free
from backend.pipeline.plan.fast_shortcut import shortened
from backend.pipeline.plan.fast_tree import Roots, Sampling, grow
from backend.pipeline.plan.seed_path import ahead, along, without_repeats
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

SEEDED_SHARE = 0.25
"""Of the budget, for the trees that begin with the previous path."""
NEAR_PATH, NEAR_ENDS = 0.8, 0.5
"""Share of the samples drawn around the previous path and the ends; and around the ends when there is no path."""


class FastPlanner:
    """Straight edge; else along the previous path and then straight; else trees from it; else from the ends alone."""

    grasps_at_once = 100

    def __init__(self, config: FastLadder) -> None:
        self.config = config

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """See ``Planner.plan``."""
        ends = check_ends(request, scene)
        if isinstance(ends, Refusal):
            return ends
        arrays = scene.arrays
        start = _rows(ends.start)
        rest = _rows(ahead(ends, request.seed_path if self.config.seeded else None))
        goals = _rows(np.array([goal for _, goal in ends.goals]))
        reached, follow, checks = first_reached(arrays, start, rest, goals)
        if reached >= 0:
            how = "reconnected" if follow else "straight"
            return _plan(ends, np.vstack([start, rest[:follow], goals[reached]]), reached, how, checks)
        limits = scene.kinematics.limits
        rng = np.random.default_rng(request.rng_seed)
        spent_at = checks + self.config.max_checks
        if len(rest):
            starts, roots, cost = _chains(arrays, start, rest, goals)
            checks += cost
            centres = np.vstack([along(np.vstack([start, rest]))[0], goals])
            sampling = sampled_box(centres, limits), centres, NEAR_PATH
            budget = int(SEEDED_SHARE * self.config.max_checks)
            path, cost = _search(arrays, starts, roots, sampling, rng, budget)
            checks += cost
            if len(path):
                return _plan(ends, path, _index(goals, path[-1]), "seeded", checks)
        centres = np.vstack([start, goals])
        sampling = sampled_box(centres, limits), centres, NEAR_ENDS
        path, cost = _search(arrays, _roots(start[None]), _roots(goals), sampling, rng, spent_at - checks)
        checks += cost
        if len(path):
            return _plan(ends, path, _index(goals, path[-1]), "unseeded", checks)
        return Refusal(f"no path to any of {len(goals)} goals found", checks)


def _plan(ends: Ends, path: Array, goal: int, how: str, checks: int) -> Plan:
    waypoints = without_repeats(np.vstack([ends.lead[:-1], path]))
    return Plan(Path(waypoints), ends.goals[goal][0], how, checks)


def _search(
    scene: SceneArrays, starts: Roots, goals: Roots, sampling: Sampling, rng: np.random.Generator, budget: int
) -> tuple[Array, int]:
    """(n, dof) a path whose every edge is free, no rows when the budget did not do; and the state checks it took."""
    path, checks = grow(scene, starts, goals, sampling, rng, budget)
    if not len(path):
        return path, checks
    path, cost = shortened(scene, without_repeats(path), rng)
    return path, checks + cost


def _chains(scene: SceneArrays, start: Array, rest: Array, goals: Array) -> tuple[Roots, Roots, int]:
    """What still holds of the previous path as the beginnings of two trees: from the start on, and back from a goal."""
    count, checks = still_free(scene, start, rest)
    ahead_states, _ = along(np.vstack([start, rest[:count]]))
    starts = ahead_states, np.arange(-1, len(ahead_states) - 1)
    backwards = np.ascontiguousarray(rest[count:][::-1])
    for g, goal in enumerate(goals):
        held, cost = still_free(scene, goal, backwards)
        checks += cost
        if held:
            back, _ = along(np.vstack([goal, backwards[:held]]))
            parents = np.concatenate([np.full(len(goals), -1), [g], np.arange(len(goals), len(goals) + len(back) - 2)])
            return starts, (np.vstack([goals, back[1:]]), parents), checks
    return starts, _roots(goals), checks


def _roots(qs: Array) -> Roots:
    return qs, np.full(len(qs), -1)


def _rows(qs: Array) -> Array:
    """As kernels want them."""
    return np.ascontiguousarray(qs, dtype=np.float64)


def _index(goals: Array, q: Array) -> int:
    return int(np.flatnonzero((goals == q).all(axis=1))[0])
