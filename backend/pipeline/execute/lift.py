"""Lift: straight up, while what speed the hand still has, and what turning, dies away."""

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute.blend import SHORTEST_LIFT_S, lift_way, rotations
from backend.pipeline.execute.cartesian import WITHIN, ArmState, follow, knot_times, limit_ratio
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.values import Refusal
from backend.trajectory import Trajectory

STRETCHES = 6


def plan_lift(kinematics: Kinematics, limits: JointLimits, arm: ArmState, lift_m: float) -> Trajectory | Refusal:
    """Raise the tcp by ``lift_m`` as fast as the joints allow, at least ``SHORTEST_LIFT_S`` long."""
    T0 = kinematics.fk(arm.q)
    rates = kinematics.jacobian(arm.q) @ arm.qd
    duration_s = SHORTEST_LIFT_S
    for _ in range(STRETCHES):
        t_s = knot_times(duration_s)
        Ts = np.tile(T0, (len(t_s), 1, 1))
        Ts[:, :3, 3] += lift_way(t_s, rates[:3], duration_s, lift_m)
        turned = lift_way(t_s, rates[3:], duration_s, 0.0)
        Ts[:, :3, :3] = rotations(turned) @ T0[:3, :3]
        trajectory = follow(kinematics, arm, t_s, Ts)
        if trajectory is None:
            return Refusal("the arm cannot follow a straight lift on one IK branch")
        ratio = limit_ratio(trajectory, limits)
        if ratio <= WITHIN:
            return trajectory
        duration_s *= min(max(1.03 * ratio, 1.05), 2.0)
    return Refusal("the joints are too slow for the lift")
