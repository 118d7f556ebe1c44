"""OMPL's RRT-Connect behind one function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from backend.pipeline.plan.ends import sampled_box
from backend.pipeline.plan.ompl_space import space_information, start_random_numbers
from backend.pipeline.plan.seed_path import CheckCount
from backend.pose import Array

RANGE_RAD = 1.0
"""Longest edge the trees grow by."""


@dataclass(frozen=True, eq=False)
class TreePath:
    """A path between one of the starts and one of the goals."""

    waypoints: Array
    start_index: int
    goal_index: int


def connect(
    starts: Array, goals: Array, limits: Array, count: CheckCount, max_checks: int, rng_seed: int
) -> TreePath | None:
    """Grow trees from free ``starts`` (n, dof) and ``goals`` (m, dof) until they meet or checks run out."""
    start_random_numbers(rng_seed)
    stop_at = count.checks + max_checks
    info = space_information(sampled_box(np.vstack([starts, goals]), limits), count.is_free, count.edge_free)
    info.setup()
    problem = _problem(info, starts, goals)
    tree = og.RRTConnect(info)
    tree.setRange(RANGE_RAD)
    tree.setProblemDefinition(problem)
    tree.setup()
    tree.solve(ob.PlannerTerminationCondition(_budget(count, stop_at, max_checks)))
    if not problem.hasExactSolution():
        return None
    return _path(problem, starts, goals)


def _budget(count: CheckCount, stop_at: int, most_calls: int) -> Callable[[], bool]:
    """True when the checks are spent, or when asked as often: a search without checks ends too."""
    calls = 0

    def spent() -> bool:
        nonlocal calls
        calls += 1
        return count.checks >= stop_at or calls > most_calls

    return spent


def _problem(info: Any, starts: Array, goals: Array) -> Any:
    problem = ob.ProblemDefinition(info)
    region = ob.GoalStates(info)
    state = info.allocState()
    dof = starts.shape[1]
    for add, postures in ((problem.addStartState, starts), (region.addState, goals)):
        for q in postures:
            state[0:dof] = [float(angle) for angle in q]
            add(state)
    problem.setGoal(region)
    return problem


def _path(problem: Any, starts: Array, goals: Array) -> TreePath:
    dof = starts.shape[1]
    waypoints = np.array([state[0:dof] for state in problem.getSolutionPath().getStates()])
    start = int(np.argmin(np.abs(starts - waypoints[0]).max(axis=1)))
    goal = int(np.argmin(np.abs(goals - waypoints[-1]).max(axis=1)))
    waypoints[0], waypoints[-1] = starts[start], goals[goal]
    return TreePath(waypoints, start, goal)
