"""Planner: what every way of planning a path has in common."""

from typing import Protocol

from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.sim.planning_scene import PlanningScene


class Planner(Protocol):
    """Finds a path from a start to the first goal it can reach."""

    grasps_at_once: int
    """The goals of how many picked grasps it wants in one request while the arm is on its way to one of them."""

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """A path that starts at ``q_start`` and ends exactly at a goal, or why there is none.

        The answer depends on the request and the scene only: the same seed gives the same path.
        """
        ...
