"""Evade: out of the moving object's way, while no grasp can be moved to without pushing the object."""

from collections.abc import Iterator

import numpy as np

from backend.pipeline.execute import ArmState
from backend.pipeline.execute.approach import ObjectAt
from backend.pipeline.rehearse import LOOK_EVERY_S, Rehearsal
from backend.pipeline.retime import JointLimits
from backend.pipeline.retime.direct import direct
from backend.pose import Array
from backend.trajectory import Trajectory

WITHIN_S = 2.0
"""A contact that is further off may still be avoided by a grasp that is found meanwhile."""
STEPS_RAD = (0.2, 0.4, 0.8)
"""How far one joint, or all of them towards home, go out of the way; the nearest way that is free is taken."""
WORTH_S = 0.3
"""A way that only puts off the contact is taken if it does so by this."""


def evade(
    rehearsal: Rehearsal,
    limits: JointLimits,
    arm: ArmState,
    in_force: Array,
    object_at: ObjectAt,
    home: Array,
) -> Trajectory | None:
    """A motion that keeps clear of the object, or nearly; None while the motion in force does, or where there is none.

    ``in_force`` (n, dof): where the arm would be without it, every ``LOOK_EVERY_S`` from ``arm.t_s`` on. Free ways come
    first, the shortest of them; else the one that meets the object last.
    """
    t_s: Array = arm.t_s + LOOK_EVERY_S * np.arange(len(in_force), dtype=np.float64)
    Ts_world_object = object_at(t_s)
    met = rehearsal.meets(in_force, Ts_world_object)
    if met is None or met[0] * LOOK_EVERY_S > WITHIN_S:
        return None
    own = limits.used(arm.qd)
    best: Trajectory | None = None
    latest = met[0] + WORTH_S / LOOK_EVERY_S
    for goal in _goals(arm.q, home, rehearsal.kinematics.limits):
        motion = direct(arm.q, arm.qd, goal, own).shifted(arm.t_s)
        met = rehearsal.meets(motion.positions(t_s), Ts_world_object)
        if met is None:
            return motion
        if met[0] >= latest:
            best, latest = motion, met[0] + 1
    return best


def _goals(q: Array, home: Array, bounds: Array) -> Iterator[Array]:
    """Postures to go to: near ones first."""
    gap = float(np.abs(home - q).max())
    for step_rad in STEPS_RAD:
        if gap > 0.0:
            yield q + (home - q) * min(1.0, step_rad / gap)
        for joint in range(len(q)):
            for sign in (1.0, -1.0):
                goal = q.copy()
                goal[joint] += sign * step_rad
                if bounds[0, joint] <= goal[joint] <= bounds[1, joint]:
                    yield goal
