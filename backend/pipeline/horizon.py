"""How far ahead of the end of thinking the object's pose is predicted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.kinematics import Kinematics
from backend.methods.method import HorizonConfig, Intercept
from backend.pipeline.execute import ArmState
from backend.pipeline.execute.approach import ObjectAt
from backend.pipeline.retime import JointLimits, least_s
from backend.pose import Array, Pose

LATER_S = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.4, 1.9, 2.5, 3.2, 4.0, 5.0, 6.0])
"""So much later than the motion in force ends are meetings with its grasp looked for."""
ANEW_S = (1.0, 2.0, 3.0, 4.5, 6.0, 8.0)
"""Times of meetings that are looked for with any grasp, where there is none to go on with."""
IN_TIME_S = 0.05
"""The arm may come so much after the object: that is put right on the way."""
SLOWEST = 2.0
"""Most that a motion is taken to last, over the least that its joints need."""


@dataclass(frozen=True, eq=False)
class Underway:
    """A grasp the arm is moving to."""

    arm: ArmState
    """When thinking ends."""
    q_end: Array
    """(dof,) where the motion in force ends."""
    left_s: float
    """Of the motion in force, when thinking ends."""
    T_object_pregrasp: Pose
    hand_to_pregrasp_m: float
    """From where the hand will be when thinking ends."""


def horizons_s(
    config: HorizonConfig, underway: Underway | None, object_at: ObjectAt, kinematics: Kinematics, limits: JointLimits
) -> tuple[tuple[float, bool], ...]:
    """Seconds ahead, to be tried in turn until a grasp can be picked, and whether it must be reached in time."""
    if isinstance(config, Intercept):
        anew = tuple((ahead_s, True) for ahead_s in ANEW_S if ahead_s <= config.longest_s)
        if underway is None:
            return anew or ((config.longest_s, True),)
        return ((_meeting_s(config, underway, object_at, kinematics, limits), False), *anew)
    if underway is None or underway.hand_to_pregrasp_m > config.far_m:
        return ((config.far_s, False),)
    return ((config.middle_s if underway.hand_to_pregrasp_m > config.near_m else config.near_s, False),)


def in_time(arm: ArmState, goal: Array, ahead_s: float, limits: JointLimits) -> bool:
    """Whether the arm's joints could be at ``goal`` (dof,) so far ahead."""
    return float(least_s(arm.q, arm.qd, goal[None], limits)[0]) <= ahead_s + IN_TIME_S


def _meeting_s(
    config: Intercept, underway: Underway, object_at: ObjectAt, kinematics: Kinematics, limits: JointLimits
) -> float:
    """The earliest time, from the end of the motion in force on, at which arm and grasp can meet; that end if none.

    Without looking later, the arm would go again and again to where a fast object will be when the arm would have been
    where the object was.
    """
    arm, q_end = underway.arm, underway.q_end
    left_s = min(max(underway.left_s, 0.0), config.longest_s)
    times = left_s + LATER_S
    times = times[times <= config.longest_s]
    Ts_pregrasp = object_at(arm.t_s + times) @ underway.T_object_pregrasp.matrix
    goals, found = kinematics.ik_each(Ts_pregrasp, np.tile(q_end, (len(times), 1)))
    ends = np.concatenate([q_end[None], np.where(found[:, None], goals, q_end)])
    needed_s = least_s(arm.q, arm.qd, ends, limits)
    slower = left_s / max(float(needed_s[0]), 1e-9)
    meets = found & (min(max(slower, 1.0), SLOWEST) * needed_s[1:] <= times + IN_TIME_S)
    return float(times[int(np.argmax(meets))]) if meets.any() else left_s
