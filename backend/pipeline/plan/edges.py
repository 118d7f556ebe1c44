"""Compiled edge checks that compiled planners share."""

from __future__ import annotations

from backend.kinematics.collision import BodyArrays, Margins, RobotArrays, edge_checks
from backend.kinematics.compiled import kernel
from backend.pose import Array
from backend.sim.planning_scene import RESOLUTION_RAD

SceneArrays = tuple[RobotArrays, BodyArrays, Margins, int]
"""Robot, bodies, margins and options, see ``PlanningScene.arrays``."""


@kernel
def edge_cost(scene: SceneArrays, q0: Array, q1: Array) -> int:
    """State checks that the straight edge from free ``q0`` to ``q1`` took, negative when it is blocked."""
    robot, bodies, margins, options = scene
    return edge_checks(robot, bodies, margins, options, q0, q1, RESOLUTION_RAD)


@kernel
def edges_free(scene: SceneArrays, qs: Array) -> int:
    """State checks that all edges of a path took, negative when one is blocked. Its first posture must be free."""
    checks = 0
    for i in range(qs.shape[0] - 1):
        cost = edge_cost(scene, qs[i], qs[i + 1])
        checks += abs(cost)
        if cost < 0:
            return -checks
    return checks
