"""IK for the whole database: keep the reachable grasps that lift best and lie nearest."""

import numpy as np

from backend.methods.method import IkFilter
from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.reach import joint_goal
from backend.pipeline.values import Candidates, JointGoal, Shortlist

DISTANCE_WEIGHT_PER_RAD = 0.02
"""How much measured lift success a radian on the way to the pregrasp outweighs."""


def shortlist_by_ik(config: IkFilter, candidates: Candidates, context: RankContext) -> Shortlist:
    """Solve pregrasp, grasp and lift of every candidate; score by quality less a little for the way there."""
    n = len(candidates.quality)
    qs_pregrasp, found = context.kinematics.ik_many(candidates.Ts_world_pregrasp, context.q)
    score = np.full(n, np.nan)
    rejected: dict[int, str] = {}
    branches: dict[int, tuple[JointGoal, ...]] = {}
    for i in range(n):
        if not found[i]:
            rejected[i] = "pregrasp out of reach"
            continue
        goal = joint_goal(
            context.kinematics, context.scene, candidates.Ts_world_grasp[i], qs_pregrasp[i], context.lift_m
        )
        if isinstance(goal, str):
            rejected[i] = goal
            continue
        way_rad = float(np.linalg.norm(goal.q_pregrasp - context.q))
        score[i] = candidates.quality[i] - DISTANCE_WEIGHT_PER_RAD * way_rad
        branches[i] = (goal,)
    ranked = sorted(branches, key=lambda i: (i != context.held, -score[i], i))
    for i in ranked[config.keep :]:
        rejected[i] = "reachable, but others rank higher"
    kept = tuple(ranked[: config.keep])
    return Shortlist(candidates, kept, score, rejected, {i: branches[i] for i in kept})
