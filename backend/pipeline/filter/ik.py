"""IK for the whole database: keep the reachable grasps that lift best and lie nearest."""

import numpy as np

from backend.methods.method import IkFilter
from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.reach import joint_goal
from backend.pipeline.values import Candidates, JointGoal, Shortlist
from backend.pose import Array

DISTANCE_WEIGHT_PER_RAD = 0.02
"""How much measured lift success a radian on the way to the pregrasp outweighs."""
OTHER_BRANCHES = 6
"""IK branches tried for a grasp whose first solution is blocked."""


def shortlist_by_ik(config: IkFilter, candidates: Candidates, context: RankContext) -> Shortlist:
    """Solve pregrasp, grasp and lift of every candidate; score by quality less a little for the way there.

    Where the first IK solution of a pregrasp is blocked, other branches are tried, best grasps first, until there
    are enough.
    """
    n = len(candidates.quality)
    qs_pregrasp, found = context.kinematics.ik_many(candidates.Ts_world_pregrasp, context.q)
    rejected = {int(i): "pregrasp out of reach" for i in np.flatnonzero(~found)}
    goals: dict[int, JointGoal] = {}
    for i in np.flatnonzero(found):
        _try(int(i), qs_pregrasp[i], candidates, context, goals, rejected)
    blocked = sorted(
        (int(i) for i in np.flatnonzero(found) if int(i) not in goals),
        key=lambda i: _rank(i, candidates, context),
    )
    for i in blocked:
        if len(goals) >= config.keep:
            break
        T_pregrasp = candidates.Ts_world_pregrasp[i]
        for q_pregrasp in context.kinematics.ik_branches(T_pregrasp, context.q, OTHER_BRANCHES):
            if _try(i, q_pregrasp, candidates, context, goals, rejected):
                break
    score = np.full(n, np.nan)
    for i, goal in goals.items():
        way_rad = float(np.linalg.norm(goal.q_pregrasp - context.q))
        score[i] = candidates.quality[i] - DISTANCE_WEIGHT_PER_RAD * way_rad
    ranked = sorted(goals, key=lambda i: (i != context.held, -score[i], i))
    for i in ranked[config.keep :]:
        rejected[i] = "reachable, but others rank higher"
    kept = tuple(ranked[: config.keep])
    return Shortlist(candidates, kept, score, rejected, {i: (goals[i],) for i in kept})


def _rank(index: int, candidates: Candidates, context: RankContext) -> tuple[bool, float, int]:
    """Sort key: the held grasp first, then the best."""
    return index != context.held, -float(candidates.quality[index]), index


def _try(
    index: int,
    q_pregrasp: Array,
    candidates: Candidates,
    context: RankContext,
    goals: dict[int, JointGoal],
    rejected: dict[int, str],
) -> bool:
    """Enter a candidate's goal on the branch of ``q_pregrasp``, or why there is none."""
    T_grasp = candidates.Ts_world_grasp[index]
    goal = joint_goal(context.kinematics, context.scene, T_grasp, q_pregrasp, context.lift_m)
    if isinstance(goal, str):
        rejected[index] = goal
        return False
    goals[index] = goal
    rejected.pop(index, None)
    return True
