"""Reach: the joint goals of grasps, from pregrasp over grasp to lift on one IK branch, clear of what is known."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import Kinematics
from backend.pipeline.values import JointGoal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene

SAME_BRANCH_RAD = 1.2
"""Pregrasp and grasp lie on one branch when no joint differs by more."""


def joint_goals(
    kinematics: Kinematics, scene: PlanningScene, Ts_world_grasp: Array, qs_pregrasp: Array, lift_m: float
) -> list[JointGoal | str]:
    """For each pregrasp posture (n, dof): the goal that continues it to its grasp (n, 4, 4) and to the lift.

    Where it breaks off, a reason in words stands instead. Every step is one compiled call for all that are left.
    """
    outcome: list[JointGoal | str] = [""] * len(qs_pregrasp)
    left = np.arange(len(qs_pregrasp))
    qs_grasp, found = _continued(kinematics, Ts_world_grasp, qs_pregrasp)
    left = _keep(left, found, outcome, lambda _: "grasp out of reach")
    left = _keep(
        left,
        scene.free_many(qs_pregrasp[left]),
        outcome,
        lambda i: f"pregrasp: {scene.why_blocked(qs_pregrasp[i])}",
    )
    left = _keep(
        left,
        scene.free_many(qs_grasp[left], hand_may_touch_target=True),
        outcome,
        lambda i: f"grasp: {scene.why_blocked(qs_grasp[i], hand_may_touch_target=True)}",
    )
    Ts_world_lift = Ts_world_grasp[left].copy()
    Ts_world_lift[:, 2, 3] += lift_m
    qs_lift, found = _continued(kinematics, Ts_world_lift, qs_grasp[left])
    qs_lift = qs_lift[found]
    left = _keep(left, found, outcome, lambda _: "lift out of reach")
    lift_of = dict(zip(left.tolist(), qs_lift, strict=True))
    left = _keep(
        left,
        scene.free_many(qs_lift, target=False),
        outcome,
        lambda i: f"lift: {scene.why_blocked(lift_of[i], target=False)}",
    )
    for i in left:
        outcome[i] = JointGoal(qs_pregrasp[i], qs_grasp[i])
    return outcome


def _continued(kinematics: Kinematics, Ts: Array, qs: Array) -> tuple[Array, NDArray[np.bool_]]:
    """IK of each pose from its own posture, and whether it was found on the same branch."""
    found_qs, found = kinematics.ik_each(Ts, qs)
    return found_qs, found & (np.abs(found_qs - qs).max(axis=1, initial=0.0) <= SAME_BRANCH_RAD)


def _keep(
    left: NDArray[np.int64], good: NDArray[np.bool_], outcome: list[JointGoal | str], why: Callable[[int], str]
) -> NDArray[np.int64]:
    """Those of ``left`` that are ``good``; the others' reasons are entered."""
    for i in left[~good]:
        outcome[i] = why(int(i))
    return left[good]
