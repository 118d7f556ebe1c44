"""PickGrasp: the shortlisted grasps in order of their distance in joint space, over all IK branches."""

import numpy as np

from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.reach import joint_goals
from backend.pipeline.values import Candidate, JointGoal, Shortlist
from backend.pose import Array, Pose

BRANCHES = 4
SAME_POSTURE_RAD = 0.05
HELD_DISCOUNT = 0.7
"""The grasp the arm is moving to counts as this much nearer, so that it is not left for a trifle."""


def pick_nearest(shortlist: Shortlist, context: RankContext) -> tuple[tuple[Candidate, ...], dict[int, str]]:
    """The reachable grasps of the shortlist, nearest first, and why the others are not.

    While the arm is on its way to a grasp that is still on the list, the solutions that the filter has found next
    to the arm's posture are near enough; otherwise every IK branch of every grasp is looked at.
    """
    everywhere = context.held is None or context.held not in shortlist.branches
    picked: list[Candidate] = []
    refused: dict[int, str] = {}
    for index in shortlist.kept:
        goals, why = _goals(shortlist, index, context, everywhere)
        if not goals:
            refused[index] = why
            continue
        c = shortlist.candidates
        picked.append(
            Candidate(
                index=index,
                T_object_grasp=Pose(c.Ts_object_grasp[index]),
                T_world_grasp=Pose(c.Ts_world_grasp[index]),
                T_world_pregrasp=Pose(c.Ts_world_pregrasp[index]),
                goals=tuple(goals),
                joint_distance_rad=distance_rad(goals[0], context.q),
            )
        )

    def cost(candidate: Candidate) -> tuple[float, int]:
        discount = HELD_DISCOUNT if candidate.index == context.held else 1.0
        return discount * candidate.joint_distance_rad, candidate.index

    return tuple(sorted(picked, key=cost)), refused


def distance_rad(goal: JointGoal, q: Array) -> float:
    """``|q_pregrasp - q| + |q_grasp - q|``."""
    return float(np.linalg.norm(goal.q_pregrasp - q) + np.linalg.norm(goal.q_grasp - q))


def _goals(shortlist: Shortlist, index: int, context: RankContext, everywhere: bool) -> tuple[list[JointGoal], str]:
    """Joint goals on distinct branches, nearest first; the last reason in words when there is none."""
    c = shortlist.candidates
    goals = list(shortlist.branches.get(index, ()))
    if goals and not everywhere:
        return goals, ""
    found = context.kinematics.ik_branches(c.Ts_world_pregrasp[index], context.q, BRANCHES)
    fresh = [q for q in found if all(np.abs(q - goal.q_pregrasp).max() >= SAME_POSTURE_RAD for goal in goals)]
    why = "pregrasp out of reach"
    if fresh:
        Ts_grasp = np.repeat(c.Ts_world_grasp[index][None], len(fresh), axis=0)
        for goal in joint_goals(context.kinematics, context.scene, Ts_grasp, np.array(fresh), context.lift_m):
            if isinstance(goal, str):
                why = goal
            else:
                goals.append(goal)
    return sorted(goals, key=lambda goal: distance_rad(goal, context.q)), why
