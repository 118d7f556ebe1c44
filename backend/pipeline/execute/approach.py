"""Approach: from wherever the hand is near the pregrasp, along the grasp's axis, into a moving object."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute.blend import rotations, rotvec, to_zero
from backend.pipeline.execute.cartesian import ArmState, follow, knot_times, speed_ratio
from backend.pipeline.values import Refusal
from backend.pose import Array, Pose, inverse
from backend.trajectory import Trajectory

ObjectAt = Callable[[Array], Array]
"""Simulated times (n,) -> predicted Ts_world_object (n, 4, 4)."""

ALIGN_PART = 0.55
"""The hand is on the grasp's axis, turned rightly, after this part of the approach."""
STRETCHES = 5
LONGEST_S = 6.0


@dataclass(frozen=True, eq=False)
class Approach:
    """The way in, and the moment from which the hand rides along with the object."""

    trajectory: Trajectory
    """Goes on riding along after ``arrive_s`` for as long as was asked."""
    arrive_s: float


def plan_approach(
    kinematics: Kinematics,
    velocity_rps: Array,
    arm: ArmState,
    object_at: ObjectAt,
    T_object_grasp: Pose,
    shortest_s: float,
    ride_s: float,
) -> Approach | Refusal:
    """Reach the grasp on the moving object in ``shortest_s`` or, where joints are too slow, as soon as they can.

    Seen from the object, the hand first settles onto the grasp's axis and then slides in along it; it starts
    with the velocity it has and arrives at rest relative to the object, with which it then rides ``ride_s`` on.
    """
    duration_s = shortest_s
    for _ in range(STRETCHES):
        t_s = knot_times(duration_s + ride_s)
        Ts = _tcp_poses(kinematics, arm, t_s, duration_s, object_at(arm.t_s + t_s), T_object_grasp)
        trajectory = follow(kinematics, arm, t_s, Ts)
        if trajectory is None:
            return Refusal("the arm cannot follow the approach on one IK branch")
        ratio = speed_ratio(trajectory, velocity_rps)
        if ratio <= 1.0:
            return Approach(trajectory, arm.t_s + duration_s)
        duration_s *= min(max(1.03 * ratio, 1.05), 2.0)
        if duration_s > LONGEST_S:
            break
    return Refusal("the joints are too slow for the approach")


def _tcp_poses(
    kinematics: Kinematics,
    arm: ArmState,
    t_s: Array,
    duration_s: float,
    Ts_object: Array,
    T_object_grasp: Pose,
) -> Array:
    """(n, 4, 4) T_world_tcp at the knots ``t_s`` (n,)."""
    Ts_grasp = Ts_object @ T_object_grasp.matrix
    offset = inverse(Ts_grasp[0]) @ kinematics.fk(arm.q)
    twist = kinematics.jacobian(arm.q) @ arm.qd
    grasp_velocity = (Ts_grasp[1, :3, 3] - Ts_grasp[0, :3, 3]) / (t_s[1] - t_s[0])
    R_grasp_world = Ts_grasp[0, :3, :3].T
    drift = R_grasp_world @ (twist[:3] - grasp_velocity)
    spin = R_grasp_world @ twist[3:]
    align_s = ALIGN_PART * duration_s
    place = to_zero(offset[:3, 3], drift, duration_s, t_s)
    place[:, :2] = to_zero(offset[:2, 3], drift[:2], align_s, t_s)
    Ts_grasp_tcp = np.tile(np.eye(4), (len(t_s), 1, 1))
    Ts_grasp_tcp[:, :3, :3] = rotations(to_zero(rotvec(offset[:3, :3]), spin, align_s, t_s))
    Ts_grasp_tcp[:, :3, 3] = place
    return Ts_grasp @ Ts_grasp_tcp
