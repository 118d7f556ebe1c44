"""Approach: from wherever the hand is near the pregrasp, along the grasp's axis, into a moving object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute.blend import rotations, rotvec, to_zero
from backend.pipeline.execute.cartesian import WITHIN, ArmState, follow, knot_times, limit_ratio
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
RATES_OVER_S = 0.01
"""Half the time over which the hand's rates relative to the grasp are measured."""
SETTLES_YET_S = 0.25
"""A hand that is to slide in at some moment may settle so long after it: a slide begins slowly."""
KEPT_SHARE = 0.9
"""A slide that had to be slow is corrected to one that may be quicker by so much."""
STRETCHES = 6
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
    offset, drift, spin = _relative_state(kinematics, request)
    sideways_m = float(np.linalg.norm(offset[:3, 3] + [0.0, 0.0, request.backoff_m]))
    turn_rad = float(np.linalg.norm(rotvec(offset[:3, :3])))
    align_s = max(SHORTEST_ALIGN_S, sideways_m / ALIGN_MPS, turn_rad / ALIGN_RPS)
    slide_s = request.slide_s
    back = np.array([0.0, 0.0, -request.backoff_m])
    for _ in range(STRETCHES):
        from_s = align_s if request.slide_from_s is None else max(request.slide_from_s, align_s - SETTLES_YET_S)
        t_s = knot_times(from_s + slide_s + request.ride_s)
        still_back = to_zero(np.ones(1), np.zeros(1), slide_s, np.maximum(t_s - from_s, 0.0))
        place = still_back * back + to_zero(offset[:3, 3] - back, drift, align_s, t_s)
        turn = to_zero(rotvec(offset[:3, :3]), spin, align_s, t_s)
        trajectory = _followed(kinematics, request, t_s, place, turn)
        if trajectory is None:
            return Refusal("the arm cannot follow the approach on one IK branch")
        aligning = limit_ratio(trajectory, limits, until_s=align_s)
        sliding = limit_ratio(trajectory, limits, from_s=from_s)
        if max(aligning, sliding) <= WITHIN:
            slide_start_s = request.arm.t_s + from_s
            return _approach(trajectory, slide_start_s, slide_start_s + slide_s, request)
        align_s *= _stretch(aligning)
        slide_s *= _stretch(sliding)
        if from_s + slide_s > LONGEST_S:
            break
    return Refusal("the joints are too slow for the approach")


def correct_approach(
    kinematics: Kinematics, limits: JointLimits, request: ApproachRequest, arrive_s: float
) -> Approach | Refusal:
    """Bend a slide that is under way to a new prediction, without changing when it arrives."""
    offset, drift, spin = _relative_state(kinematics, request)
    left_s = arrive_s - request.arm.t_s
    t_s = knot_times(left_s + request.ride_s)
    place = to_zero(offset[:3, 3], drift, left_s, t_s)
    turn = to_zero(rotvec(offset[:3, :3]), spin, left_s, t_s)
    trajectory = _followed(kinematics, request, t_s, place, turn)
    if trajectory is None or limit_ratio(trajectory, limits) > WITHIN:
        return Refusal("the correction is beyond the arm")
    return _approach(trajectory, request.arm.t_s, arrive_s, request)


def _approach(trajectory: Trajectory, slide_s: float, arrive_s: float, request: ApproachRequest) -> Approach:
    T_world_object = Pose(request.object_at(np.array([arrive_s]))[0])
    return Approach(trajectory, slide_s, arrive_s, T_world_object)


def _stretch(ratio: float) -> float:
    return min(max(1.03 * ratio, 1.05), 2.0) if ratio > 1.0 else 1.0


def _relative_state(kinematics: Kinematics, request: ApproachRequest) -> tuple[Array, Array, Array]:
    """T_grasp_tcp (4, 4) now, and the rates of its position, (3,) m/s, and of its rotation vector, (3,) rad/s."""
    arm = request.arm
    steps_s = np.array([-RATES_OVER_S, 0.0, RATES_OVER_S])
    Ts_grasp = request.object_at(arm.t_s + steps_s) @ request.T_object_grasp.matrix
    before, now, after = inverse(Ts_grasp) @ kinematics.fk_many(arm.q + steps_s[:, None] * arm.qd)
    spin = (rotvec(after[:3, :3]) - rotvec(before[:3, :3])) / (2.0 * RATES_OVER_S)
    return now, (after[:3, 3] - before[:3, 3]) / (2.0 * RATES_OVER_S), spin


def _followed(
    kinematics: Kinematics, request: ApproachRequest, t_s: Array, place: Array, turn: Array
) -> Trajectory | None:
    """Trajectory along T_grasp_tcp, given as positions (n, 3) and rotation vectors (n, 3) at the knots (n,)."""
    Ts_grasp = request.object_at(request.arm.t_s + t_s) @ request.T_object_grasp.matrix
    Ts_grasp_tcp = np.tile(np.eye(4), (len(t_s), 1, 1))
    Ts_grasp_tcp[:, :3, :3] = rotations(turn)
    Ts_grasp_tcp[:, :3, 3] = place
    return follow(kinematics, request.arm, t_s, Ts_grasp @ Ts_grasp_tcp)
