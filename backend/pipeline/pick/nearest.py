"""PickGrasp: the shortlisted grasps in order of their distance in joint space, over all IK branches."""

from collections.abc import Sequence

import numpy as np

from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.reach import joint_goals
from backend.pipeline.values import Candidate, Candidates, JointGoal, Shortlist
from backend.pose import Array

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
    ways_rad = _distances_rad([goals[0] for goals in goals_of.values()], context.q)
    picked = [
        Candidate(index, shortlist.candidates, goals, way_rad)
        for (index, goals), way_rad in zip(goals_of.items(), ways_rad, strict=True)
    ]

    def cost(candidate: Candidate) -> tuple[float, int]:
        discount = HELD_DISCOUNT if candidate.index == context.held else 1.0
        return discount * candidate.joint_distance_rad, candidate.index

    return tuple(sorted(picked, key=cost)), refused


def _distances_rad(goals: Sequence[JointGoal], q: Array) -> list[float]:
    """Of each goal: the turn of the joint that turns furthest, to the pregrasp and to the grasp, added up.

    All joints move at once, so that one decides how long the arm is on its way.
    """
    if not goals:
        return []
    turns = np.abs(np.array([(goal.q_pregrasp, goal.q_grasp) for goal in goals]) - q).max(axis=2)
    return (turns[:, 0] + turns[:, 1]).tolist()


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
    """The joint goals of each grasp, by index, nearest first; and why the others have none: the last reason."""
    c = shortlist.candidates
    goals_of = {index: list(shortlist.branches.get(index, ())) for index in shortlist.kept}
    why = dict.fromkeys(shortlist.kept, OUT_OF_REACH)
    fresh = [(index, q) for index, goals in goals_of.items() for q in _fresh(c, index, goals, context)]
    if fresh:
        Ts_grasp, qs = c.Ts_world_grasp[[index for index, _ in fresh]], np.array([q for _, q in fresh])
        answers = joint_goals(context.kinematics, context.scene, Ts_grasp, qs, context.lift_m)
        for (index, _), answer in zip(fresh, answers, strict=True):
            if isinstance(answer, str):
                why[index] = answer
            else:
                goals_of[index].append(answer)
    refused = {index: why[index] for index, goals in goals_of.items() if not goals}
    return {index: _nearest_first(goals, context.q) for index, goals in goals_of.items() if goals}, refused


def _fresh(candidates: Candidates, index: int, goals: Sequence[JointGoal], context: RankContext) -> list[Array]:
    """Postures at the pregrasp on branches that ``goals`` are not on."""
    found = context.kinematics.ik_branches(candidates.Ts_world_pregrasp[index], context.q, BRANCHES)
    return [q for q in found if all(np.abs(q - goal.q_pregrasp).max() >= SAME_POSTURE_RAD for goal in goals)]


def _nearest_first(goals: Sequence[JointGoal], q: Array) -> tuple[JointGoal, ...]:
    order = np.argsort(_distances_rad(goals, q), kind="stable")
    return tuple(goals[i] for i in order)
