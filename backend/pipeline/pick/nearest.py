"""PickGrasp: the shortlisted grasps in order of their distance in joint space, over all IK branches."""

import numpy as np

from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.reach import joint_goals
from backend.pipeline.values import Candidate, JointGoal, Shortlist
from backend.pose import Array, Pose

BRANCHES = 4
RESTARTS = 2
"""Fixed postures that IK also starts from when it does not get there from the arm's."""
SAME_POSTURE_RAD = 0.05
OUT_OF_REACH = "pregrasp out of reach"
HELD_DISCOUNT = 0.7
"""The grasp the arm is moving to counts as this much nearer, so that it is not left for a trifle."""


def pick_nearest(shortlist: Shortlist, context: RankContext) -> tuple[tuple[Candidate, ...], dict[int, str]]:
    """The reachable grasps of the shortlist, nearest first, and why the others are not.

    While the arm is on its way to a grasp that is still on the list, solutions next to the arm's posture are near
    enough; otherwise every IK branch of every grasp is looked at.
    """
    goals_of: dict[int, tuple[JointGoal, ...]] = {}
    refused: dict[int, str] = {}
    if context.held in shortlist.kept:
        goals_of, refused = _next_to_the_arm(shortlist, context)
    if context.held not in goals_of:
        goals_of, refused = _on_every_branch(shortlist, context)
    picked: list[Candidate] = []
    c = shortlist.candidates
    for index, goals in goals_of.items():
        picked.append(
            Candidate(
                index=index,
                T_object_grasp=Pose(c.Ts_object_grasp[index]),
                T_world_grasp=Pose(c.Ts_world_grasp[index]),
                T_world_pregrasp=Pose(c.Ts_world_pregrasp[index]),
                goals=goals,
                joint_distance_rad=distance_rad(goals[0], context.q),
            )
        )

    def cost(candidate: Candidate) -> tuple[float, int]:
        discount = HELD_DISCOUNT if candidate.index == context.held else 1.0
        return discount * candidate.joint_distance_rad, candidate.index

    return tuple(sorted(picked, key=cost)), refused


def distance_rad(goal: JointGoal, q: Array) -> float:
    """The turn of the joint that turns furthest, to the pregrasp and to the grasp, added up.

    All joints move at once, so that one decides how long the arm is on its way.
    """
    return float(np.abs(goal.q_pregrasp - q).max() + np.abs(goal.q_grasp - q).max())


def _next_to_the_arm(
    shortlist: Shortlist, context: RankContext
) -> tuple[dict[int, tuple[JointGoal, ...]], dict[int, str]]:
    """One joint goal of each grasp, by index: the filter's, or else a first solution; and why the others have none."""
    goals_of = {index: goals for index, goals in shortlist.branches.items() if index in shortlist.kept}
    refused: dict[int, str] = {}
    open_ = np.array([index for index in shortlist.kept if index not in goals_of], dtype=np.int64)
    c = shortlist.candidates
    qs, found = context.kinematics.ik_many(c.Ts_world_pregrasp[open_], context.q, RESTARTS)
    answers = iter(
        joint_goals(context.kinematics, context.scene, c.Ts_world_grasp[open_[found]], qs[found], context.lift_m)
    )
    for index, reached in zip(open_.tolist(), found.tolist(), strict=True):
        answer = next(answers) if reached else OUT_OF_REACH
        if isinstance(answer, str):
            refused[index] = answer
        else:
            goals_of[index] = (answer,)
    return goals_of, refused


def _on_every_branch(
    shortlist: Shortlist, context: RankContext
) -> tuple[dict[int, tuple[JointGoal, ...]], dict[int, str]]:
    """The joint goals of each grasp, by index, nearest first; and why the others have none."""
    goals_of: dict[int, tuple[JointGoal, ...]] = {}
    refused: dict[int, str] = {}
    for index in shortlist.kept:
        goals, why = _goals(shortlist, index, context)
        if goals:
            goals_of[index] = tuple(goals)
        else:
            refused[index] = why
    return goals_of, refused


def _goals(shortlist: Shortlist, index: int, context: RankContext) -> tuple[list[JointGoal], str]:
    """Joint goals on distinct branches, nearest first; the last reason in words when there is none."""
    c = shortlist.candidates
    goals = list(shortlist.branches.get(index, ()))
    found = context.kinematics.ik_branches(c.Ts_world_pregrasp[index], context.q, BRANCHES)
    fresh = [q for q in found if all(np.abs(q - goal.q_pregrasp).max() >= SAME_POSTURE_RAD for goal in goals)]
    why = OUT_OF_REACH
    if fresh:
        Ts_grasp = np.repeat(c.Ts_world_grasp[index][None], len(fresh), axis=0)
        for goal in joint_goals(context.kinematics, context.scene, Ts_grasp, np.array(fresh), context.lift_m):
            if isinstance(goal, str):
                why = goal
            else:
                goals.append(goal)
    return sorted(goals, key=lambda goal: distance_rad(goal, context.q)), why
