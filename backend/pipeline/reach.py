"""Reach: the joint goals of grasps, from pregrasp over grasp to lift on one IK branch, clear of what is known."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import Kinematics
from backend.pipeline.values import JointGoal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene

Integers = NDArray[np.int64]

SAME_BRANCH_RAD = 1.2
"""Pregrasp and grasp lie on one branch when no joint differs by more."""


def joint_goals(
    kinematics: Kinematics, scene: PlanningScene, Ts_world_grasp: Array, qs_pregrasp: Array, lift_m: float
) -> list[JointGoal | str]:
    """For each pregrasp posture (n, dof): the goal that continues it to its grasp (n, 4, 4) and to the lift.

    Where it breaks off, a reason in words stands instead. Every step is one compiled call for all that are left.
    """
    outcome: list[JointGoal | str] = [""] * len(qs_pregrasp)

    def keep(left: Integers, why: Sequence[str], what: str) -> Integers:
        """Those of ``left`` with nothing against them; the others' reasons are entered."""
        for i, reason in zip(left.tolist(), why, strict=True):
            if reason:
                outcome[i] = f"{what} {reason}"
        return left[[not reason for reason in why]]

    qs_grasp = qs_pregrasp.copy()
    left = keep(np.arange(len(qs_pregrasp)), scene.why_blocked_many(qs_pregrasp), "pregrasp:")
    qs_grasp[left], found = _continued(kinematics, Ts_world_grasp[left], qs_pregrasp[left])
    left = keep(left, _unless(found), "grasp")
    left = keep(left, scene.why_blocked_many(qs_grasp[left], hand_may_touch_target=True), "grasp:")
    Ts_world_lift = Ts_world_grasp[left].copy()
    Ts_world_lift[:, 2, 3] += lift_m
    qs_lift, found = _continued(kinematics, Ts_world_lift, qs_grasp[left])
    left = keep(left, _unless(found), "lift")
    left = keep(left, scene.why_blocked_many(qs_lift[found], target=False), "lift:")
    for i in left:
        outcome[i] = JointGoal(qs_pregrasp[i], qs_grasp[i])
    return outcome


def _unless(found: NDArray[np.bool_]) -> list[str]:
    return ["" if one else "out of reach" for one in found]


def _continued(kinematics: Kinematics, Ts: Array, qs: Array) -> tuple[Array, NDArray[np.bool_]]:
    """IK of each pose from its own posture, and whether it was found on the same branch."""
    found_qs, found = kinematics.ik_each(Ts, qs)
    return found_qs, found & (np.abs(found_qs - qs).max(axis=1, initial=0.0) <= SAME_BRANCH_RAD)
