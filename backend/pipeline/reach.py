"""Reach: the joint goals of a grasp, from pregrasp over grasp to lift on one IK branch, clear of what is known."""

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.values import JointGoal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene

SAME_BRANCH_RAD = 1.2
"""Pregrasp and grasp lie on one branch when no joint differs by more."""


def joint_goal(
    kinematics: Kinematics, scene: PlanningScene, T_world_grasp: Array, q_pregrasp: Array, lift_m: float
) -> JointGoal | str:
    """The goal that continues ``q_pregrasp`` (dof,) to grasp and lift; a reason in words where it breaks off."""
    q_grasp = kinematics.ik(T_world_grasp, q_pregrasp)
    if q_grasp is None or np.abs(q_grasp - q_pregrasp).max() > SAME_BRANCH_RAD:
        return "grasp out of reach"
    T_world_lift = T_world_grasp.copy()
    T_world_lift[2, 3] += lift_m
    q_lift = kinematics.ik(T_world_lift, q_grasp)
    if q_lift is None or np.abs(q_lift - q_grasp).max() > SAME_BRANCH_RAD:
        return "lift out of reach"
    if not scene.is_free(q_pregrasp):
        return f"pregrasp: {scene.why_blocked(q_pregrasp)}"
    if not scene.is_free(q_grasp, hand_may_touch_target=True):
        return f"grasp: {scene.why_blocked(q_grasp, hand_may_touch_target=True)}"
    if not scene.is_free(q_lift, target=False):
        return f"lift: {scene.why_blocked(q_lift, target=False)}"
    return JointGoal(q_pregrasp, q_grasp)
