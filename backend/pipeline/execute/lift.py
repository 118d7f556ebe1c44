"""Lift: straight up, while what horizontal speed the hand still has dies away."""

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute.blend import to_zero
from backend.pipeline.execute.cartesian import ArmState, follow, knot_times, speed_ratio
from backend.pipeline.values import Refusal
from backend.pose import Array
from backend.trajectory import Trajectory

SHORTEST_LIFT_S = 1.0
COAST_S = 0.4
STRETCHES = 6


def lift_way(t_s: Array, velocity_mps: Array, duration_s: float, lift_m: float) -> Array:
    """(n, 3) where the hand has gone ``t_s`` (n,) after the lift began at ``velocity_mps`` (3,)."""
    coasted = velocity_mps * COAST_S / 2
    way = coasted + to_zero(-coasted, velocity_mps, COAST_S, t_s)
    way[:, 2] += lift_m + to_zero(np.array([-lift_m]), np.zeros(1), duration_s, t_s)[:, 0]
    return way


def plan_lift(kinematics: Kinematics, velocity_rps: Array, arm: ArmState, lift_m: float) -> Trajectory | Refusal:
    """Raise the tcp by ``lift_m`` as fast as the joints allow, at least ``SHORTEST_LIFT_S`` long."""
    T0 = kinematics.fk(arm.q)
    velocity = (kinematics.jacobian(arm.q) @ arm.qd)[:3]
    duration_s = SHORTEST_LIFT_S
    for _ in range(STRETCHES):
        t_s = knot_times(duration_s)
        Ts = np.tile(T0, (len(t_s), 1, 1))
        Ts[:, :3, 3] += lift_way(t_s, velocity, duration_s, lift_m)
        trajectory = follow(kinematics, arm, t_s, Ts)
        if trajectory is None:
            return Refusal("the arm cannot follow a straight lift on one IK branch")
        ratio = speed_ratio(trajectory, velocity_rps)
        if ratio <= 1.0:
            return trajectory
        duration_s *= min(max(1.03 * ratio, 1.05), 2.0)
    return Refusal("the joints are too slow for the lift")
