"""OMPL's RRT-Connect behind one function; the only file that imports OMPL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from backend.pipeline.plan.seed_path import CheckCount
from backend.pose import Array

RANGE_RAD = 1.0
"""Longest edge the trees grow by."""
BEYOND_RAD = float(np.pi)
"""How far outside the box of all ends joints are sampled."""


@dataclass(frozen=True, eq=False)
class TreePath:
    """A path between one of the starts and one of the goals."""

    waypoints: Array
    start_index: int
    goal_index: int


def connect(
    starts: Array, goals: Array, limits: Array, count: CheckCount, max_checks: int, rng_seed: int
) -> TreePath | None:
    """Grow trees from free ``starts`` (n, dof) and ``goals`` (m, dof) until they meet or checks run out.

    OMPL draws the seed of every generator from one global sequence. That sequence is started anew here,
    before anything that owns a generator is made, so that the path depends on ``rng_seed`` only. OMPL logs an
    error about it, which is why its log is switched off.
    """
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(1 + rng_seed % (2**31 - 1))
    space = _space(np.vstack([starts, goals]), limits)
    info = ob.SpaceInformation(space)
    stop_at = count.checks + max_checks
    is_valid, motions = _validity(count, info, starts.shape[1])
    info.setStateValidityChecker(is_valid)
    info.setMotionValidator(motions)
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


def _space(ends: Array, limits: Array) -> Any:
    lower = np.maximum(limits[0], ends.min(axis=0) - BEYOND_RAD)
    upper = np.minimum(limits[1], ends.max(axis=0) + BEYOND_RAD)
    dof = limits.shape[1]
    bounds = ob.RealVectorBounds(dof)
    for i in range(dof):
        bounds.setLow(i, float(lower[i]))
        bounds.setHigh(i, float(upper[i]))
    space = ob.RealVectorStateSpace(dof)
    space.setBounds(bounds)
    return space


def _validity(count: CheckCount, info: Any, dof: int) -> tuple[Callable[[Any], bool], Any]:
    def is_valid(state: Any) -> bool:
        return count.is_free(np.array(state[0:dof]))

    class Motions(ob.MotionValidator):
        def checkMotion(self, a: Any, b: Any) -> bool:
            return count.edge_free(np.array(a[0:dof]), np.array(b[0:dof]))

    return is_valid, Motions(info)


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
