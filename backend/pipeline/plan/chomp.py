"""CHOMP (Ratliff, Zucker, Bagnell and Srinivasa 2009), from the previous path, straight lines and bent lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from backend.methods.method import Chomp
from backend.pipeline.plan.chomp_descent import bent_line, descend, inverse_metric, line_along, straight_line
from backend.pipeline.plan.ends import Ends, check_ends
from backend.pipeline.plan.seed_path import CheckCount, ahead, straight, without_repeats
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

BEND_RAD = 1.0
"""How far a bent line leaves the straight one, in the joint that does most."""


@dataclass(frozen=True, eq=False)
class Beginning:
    """A path to bend."""

    path: Array
    """(waypoints + 2, dof) from the start to the goal."""
    goal_index: int
    how: str


class ChompPlanner:
    """Straight edge; else the previous path joined to a goal, straight lines and bent lines, until one bends free."""

    grasps_at_once = 1

    def __init__(self, config: Chomp) -> None:
        self.config = config

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """See ``Planner.plan``. ``how`` is ``reconnected`` when the joined previous path needed no bending."""
        count = CheckCount(scene)
        ends = check_ends(request, scene)
        if isinstance(ends, Refusal):
            return ends
        found = straight(ends, count)
        if found is not None:
            return Plan(Path(without_repeats(found.waypoints)), found.goal_index, found.how, count.checks)
        tried = 0
        for beginning in self._beginnings(request, ends):
            tried += 1
            free, steps = self._descend(beginning.path, count)
            if free:
                waypoints = without_repeats(np.vstack([ends.lead[:-1], beginning.path]))
                how = "reconnected" if beginning.how == "seeded" and steps == 0 else beginning.how
                return Plan(Path(waypoints), beginning.goal_index, how, count.checks)
        why = (
            f"no path to {min(self.config.goals, len(ends.goals))} of {len(ends.goals)} goals found from {tried} lines"
        )
        return Refusal(why, count.checks)

    def _beginnings(self, request: PlanRequest, ends: Ends) -> Iterator[Beginning]:
        config = self.config
        goals = ends.goals[: config.goals]
        if config.seeded and len(rest := ahead(ends, request.seed_path)):
            yield _joined(rest, ends, config.waypoints)
        for index, goal in goals:
            yield Beginning(straight_line(ends.start, goal, config.waypoints), index, "unseeded")
        rng = np.random.default_rng(request.rng_seed)
        for bend in range(config.bends):
            index, goal = goals[bend % len(goals)]
            yield Beginning(bent_line(ends.start, goal, config.waypoints, BEND_RAD, rng), index, "unseeded")

    def _descend(self, path: Array, count: CheckCount) -> tuple[bool, int]:
        """Whether ``path`` could be bent free, in place, and in how many steps."""
        config, scene = self.config, count.scene
        metric = inverse_metric(config.waypoints)
        free, steps, checks = descend(
            scene.arrays,
            scene.kinematics.limits,
            path,
            metric,
            config.reach_m,
            config.smoothness,
            config.iterations,
        )
        count.checks += checks
        return free, steps


def _joined(rest: Array, ends: Ends, count: int) -> Beginning:
    """The start and the ``rest`` (n, dof) of the previous path, bent so that it ends at the goal nearest to its end."""
    chain = np.vstack([ends.start, rest])
    index, goal = min(ends.goals, key=lambda numbered: float(np.abs(numbered[1] - chain[-1]).max()))
    return Beginning(line_along(chain, goal, count), index, "seeded")
