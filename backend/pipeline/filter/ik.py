"""IK for the whole database: keep the reachable grasps that lift best and lie nearest."""

import numpy as np
from numpy.typing import NDArray

from backend.methods.method import IkFilter
from backend.pipeline.filter.ranking import PUT_OFF, RankContext
from backend.pipeline.reach import joint_goals
from backend.pipeline.values import Candidates, JointGoal, Shortlist
from backend.pose import Array

DISTANCE_WEIGHT_PER_RAD = 0.02
"""How much measured lift success a radian on the way to the pregrasp outweighs."""
RESTARTS = 6
"""Postures that IK of each pregrasp starts from when it does not get there from the arm's own."""
OTHER_BRANCHES = 6
"""IK branches tried for a grasp whose first solution is blocked."""
BLOCKED_TRIED_WHILE_HELD = 4
"""Of so many blocked grasps other branches are tried while the arm is on its way to a grasp that can be kept.

The others are only to fall back on then; for the same reason IK of their pregrasps starts from the arm's posture only.
"""


def shortlist_by_ik(config: IkFilter, candidates: Candidates, context: RankContext) -> Shortlist:
    """Solve the pregrasp of every candidate, score it by quality less a little for the way there, and keep the best.

    Grasp and lift are solved from the highest score down until there are enough. Where the first IK solution of
    a pregrasp is blocked, other branches are tried, if then there are still too few.
    """
    n = len(candidates.quality)
    qs_pregrasp, found = _pregrasps(candidates, context)
    rejected = {int(i): "pregrasp out of reach" for i in np.flatnonzero(~found)}
    for i in context.put_off:
        found[i], rejected[i] = False, PUT_OFF
    score = np.full(n, np.nan)
    ways_rad = np.linalg.norm(qs_pregrasp[found] - context.q, axis=1)
    score[found] = candidates.quality[found] - DISTANCE_WEIGHT_PER_RAD * ways_rad
    within = np.flatnonzero(found)
    whys = zip(within.tolist(), context.scene.why_blocked_many(qs_pregrasp[within]), strict=True)
    rejected |= {i: f"pregrasp: {why}" for i, why in whys if why}
    blocked = [i for i in within.tolist() if i in rejected]
    order = sorted(set(within.tolist()) - set(blocked), key=lambda i: (i != context.held, -score[i], i))
    goals: dict[int, JointGoal] = {}
    batch = config.keep + config.keep // 2
    while order and len(goals) < config.keep:
        tried, order = np.array(order[:batch]), order[batch:]
        for i, goal in zip(tried.tolist(), _goals(candidates, tried, qs_pregrasp[tried], context), strict=True):
            if isinstance(goal, str):
                rejected[i] = goal
                blocked.append(i)
            else:
                goals[i] = goal
    in_order = sorted(blocked, key=lambda i: (i != context.held, -float(candidates.quality[i]), i))
    for tries, i in enumerate(in_order):
        if len(goals) >= config.keep or (context.held in goals and tries >= BLOCKED_TRIED_WHILE_HELD):
            break
        other = _on_another_branch(i, candidates, context)
        if other is not None:
            goals[i] = other
            del rejected[i]
            way_rad = float(np.linalg.norm(other.q_pregrasp - context.q))
            score[i] = candidates.quality[i] - DISTANCE_WEIGHT_PER_RAD * way_rad
    ranked = sorted(goals, key=lambda i: (i != context.held, -score[i], i))
    rejected.update(dict.fromkeys((*order, *ranked[config.keep :]), "others rank higher"))
    kept = tuple(ranked[: config.keep])
    return Shortlist(candidates, kept, score, rejected, {i: (goals[i],) for i in kept})


def _pregrasps(candidates: Candidates, context: RankContext) -> tuple[Array, NDArray[np.bool_]]:
    """(n, dof) a posture for every pregrasp, NaN where none was found, and (n,) whether one was."""
    Ts, held = candidates.Ts_world_pregrasp, context.held
    if held is None:
        return context.kinematics.ik_many(Ts, context.q, RESTARTS)
    qs, found = context.kinematics.ik_many(Ts, context.q, 0)
    if not found[held]:
        qs[held : held + 1], found[held : held + 1] = context.kinematics.ik_many(Ts[held][None], context.q, RESTARTS)
    return qs, found


def _on_another_branch(index: int, candidates: Candidates, context: RankContext) -> JointGoal | None:
    """The nearest branch of one candidate that holds all the way to the lift."""
    T_pregrasp = candidates.Ts_world_pregrasp[index]
    qs = context.kinematics.ik_branches(T_pregrasp, context.q, OTHER_BRANCHES)
    goals = _goals(candidates, np.full(len(qs), index), qs, context)
    return next((goal for goal in goals if not isinstance(goal, str)), None)


def _goals(
    candidates: Candidates, indices: np.ndarray, qs_pregrasp: Array, context: RankContext
) -> list[JointGoal | str]:
    Ts_grasp = candidates.Ts_world_grasp[indices]
    return joint_goals(context.kinematics, context.scene, Ts_grasp, qs_pregrasp, context.lift_m)
