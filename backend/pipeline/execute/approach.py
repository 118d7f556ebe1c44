"""Approach: from wherever the hand is near the pregrasp, along the grasp's axis, into a moving object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute.cartesian import WITHIN, ArmState, follow, knot_times, limit_ratio
from backend.pipeline.execute.relative_way import Offset, RelativeWay, as_state
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.values import Refusal
from backend.pose import Array, Pose, inverse, rotation_angle_rad
from backend.trajectory import Trajectory

ObjectAt = Callable[[Array], Array]
"""Simulated times (n,) -> predicted Ts_world_object (n, 4, 4)."""

ALIGN_MPS = 0.06
ALIGN_RPS = 0.6
SHORTEST_ALIGN_S = 0.25
"""The hand settles onto the grasp's axis at about these speeds, and takes at least so long."""
MOMENTS_S = np.array([-0.01, 0.0, 0.01])
"""Between the outer two, the hand's rates relative to the grasp are measured."""
SETTLES_YET_S = 0.25
"""A hand that is to slide in at some moment may settle so long after it: a slide begins slowly."""
KEPT_SHARE = 0.9
"""A slide that had to be slow is corrected to one that may be quicker by so much."""
STRETCHES = 6
LATER_BY_S = 0.2
"""A correction that is beyond the arm is tried with an arrival so much later."""
LONGEST_S = 6.0
RIDE_S = 0.9
"""So long the hand rides along with the object at most; the fingers need 0.4 to 0.8 s to close."""


@dataclass(frozen=True, eq=False)
class Approach:
    """The way in, and the moment from which the hand rides along with the object."""

    trajectory: Trajectory
    """Goes on riding along after ``arrive_s`` for as long as was asked."""
    slide_s: float
    """When the hand is aligned and starts to slide in along the grasp's axis."""
    arrive_s: float
    way: RelativeWay
    """The same motion as it is seen from the grasp."""
    T_world_object: Pose
    """Where the object is expected at ``arrive_s``."""

    def off_by(self, object_at: ObjectAt) -> tuple[float, float]:
        """How far, in m and rad, the newest prediction for the arrival is from the one the approach was made for."""
        T = object_at(np.array([self.arrive_s]))[0]
        shift_m = float(np.linalg.norm(T[:3, 3] - self.T_world_object.xyz_m))
        return shift_m, rotation_angle_rad(T[:3, :3], self.T_world_object.rotation)


@dataclass(frozen=True, eq=False)
class ApproachRequest:
    """What an approach has to do."""

    arm: ArmState
    object_at: ObjectAt
    T_object_grasp: Pose
    backoff_m: float
    slide_s: float
    """Shortest time from pregrasp to grasp."""
    ride_s: float
    """How long to ride along after the arrival."""
    slide_from_s: float | None = None
    """When to slide in, counted from the arm's moment; None: when the hand has settled onto the grasp's axis."""

    def instead_of(self, approach: Approach) -> ApproachRequest:
        """The same, to slide in when ``approach`` would, though the prediction is another now."""
        left_s = approach.slide_s - self.arm.t_s
        slid_s = KEPT_SHARE * (approach.arrive_s - approach.slide_s)
        return replace(self, slide_from_s=left_s, slide_s=max(self.slide_s, slid_s))


def plan_approach(kinematics: Kinematics, limits: JointLimits, request: ApproachRequest) -> Approach | Refusal:
    """Settle onto the grasp's axis at the back-off distance, then slide in, as fast as the joints allow.

    Both happen in the frame of the moving object. The motion starts with the velocity the arm has, and arrives at
    rest relative to the object, with which it then rides along.
    """
    state, rate = _relative_state(kinematics, request)
    back = np.array([0.0, 0.0, -request.backoff_m, 0.0, 0.0, 0.0])
    aside = state - back
    align_s = max(
        SHORTEST_ALIGN_S,
        float(np.linalg.norm(aside[:3])) / ALIGN_MPS,
        float(np.linalg.norm(aside[3:])) / ALIGN_RPS,
    )
    slide_s = request.slide_s
    now_s = request.arm.t_s
    for _ in range(STRETCHES):
        from_s = align_s if request.slide_from_s is None else max(request.slide_from_s, align_s - SETTLES_YET_S)
        slide_start_s = now_s + from_s
        arrive_s = slide_start_s + slide_s
        sliding_in = Offset(back, np.zeros(6), slide_start_s, arrive_s)
        settling = Offset(aside, rate, now_s, now_s + align_s)
        way = RelativeWay((sliding_in, settling))
        trajectory = _followed(kinematics, request, way, arrive_s)
        if trajectory is None:
            return Refusal("the arm cannot follow the approach on one IK branch")
        aligning = limit_ratio(trajectory, limits, until_s=align_s)
        sliding = limit_ratio(trajectory, limits, from_s=from_s)
        if max(aligning, sliding) <= WITHIN:
            return _approach(trajectory, way, slide_start_s, arrive_s, request)
        align_s *= _stretch(aligning)
        slide_s *= _stretch(sliding)
        if from_s + slide_s > LONGEST_S:
            break
    return Refusal("the joints are too slow for the approach")


def correct_approach(
    kinematics: Kinematics, limits: JointLimits, request: ApproachRequest, approach: Approach, latest_s: float
) -> Approach | Refusal:
    """Bend a slide that is under way to a new prediction, without changing when it arrives.

    Where that is beyond the arm, it arrives as little later as it can, but not after ``latest_s``.
    """
    now_s = request.arm.t_s
    state, rate = _relative_state(kinematics, request)
    was, was_rate = _state_and_rate(approach.way.at(now_s + MOMENTS_S))
    arrive_s = approach.arrive_s
    way = RelativeWay((*approach.way.offsets, Offset(state - was, rate - was_rate, now_s, arrive_s)))
    while True:
        trajectory = _followed(kinematics, request, way, arrive_s) if arrive_s > now_s else None
        if trajectory is not None and limit_ratio(trajectory, limits) <= WITHIN:
            return _approach(trajectory, way, approach.slide_s, arrive_s, request)
        if arrive_s >= latest_s:
            return Refusal("the correction is beyond the arm")
        arrive_s = min(arrive_s + LATER_BY_S, latest_s)
        way = RelativeWay((Offset(state, rate, now_s, arrive_s),))


def _approach(
    trajectory: Trajectory, way: RelativeWay, slide_s: float, arrive_s: float, request: ApproachRequest
) -> Approach:
    T_world_object = Pose(request.object_at(np.array([arrive_s]))[0])
    return Approach(trajectory, slide_s, arrive_s, way, T_world_object)


def _stretch(ratio: float) -> float:
    return min(max(1.03 * ratio, 1.05), 2.0) if ratio > 1.0 else 1.0


def _relative_state(kinematics: Kinematics, request: ApproachRequest) -> tuple[Array, Array]:
    """(6,) position and rotation vector of the tcp in the grasp's frame now, and how fast they change."""
    arm = request.arm
    Ts_grasp = request.object_at(arm.t_s + MOMENTS_S) @ request.T_object_grasp.matrix
    Ts_grasp_tcp = inverse(Ts_grasp) @ kinematics.fk_many(arm.q + MOMENTS_S[:, None] * arm.qd)
    return _state_and_rate(np.array([as_state(T) for T in Ts_grasp_tcp]))


def _state_and_rate(states: Array) -> tuple[Array, Array]:
    """The middle one of states (3, 6) at ``MOMENTS_S``, and the rate there."""
    return states[1], (states[2] - states[0]) / (MOMENTS_S[2] - MOMENTS_S[0])


def _followed(kinematics: Kinematics, request: ApproachRequest, way: RelativeWay, arrive_s: float) -> Trajectory | None:
    """Trajectory along the way to the moving grasp, and along with it for as long as was asked."""
    t_s = knot_times(arrive_s - request.arm.t_s + request.ride_s)
    at_s = request.arm.t_s + t_s
    Ts_grasp = request.object_at(at_s) @ request.T_object_grasp.matrix
    return follow(kinematics, request.arm, t_s, Ts_grasp @ way.Ts_grasp_tcp(at_s))
