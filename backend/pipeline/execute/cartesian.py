"""Cartesian motion as a joint trajectory: dense tcp poses followed by IK on one branch, within joint limits."""

from dataclasses import dataclass

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.retime.rates import speeds, times_too_fast
from backend.pose import Array
from backend.trajectory import Trajectory

KNOTS_PER_S = 60.0
MAX_STEP_RAD = 0.15
"""A larger change of any joint between two knots is a jump to another IK branch."""
WITHIN = 1.0 + 1e-6
"""``limit_ratio`` of a motion within its limits: the arm may be at one of them when it begins."""


@dataclass(frozen=True, eq=False)
class ArmState:
    """Where the arm is commanded to be at one moment."""

    q: Array
    """(dof,) rad."""
    qd: Array
    """(dof,) rad/s."""
    t_s: float


def knot_times(duration_s: float) -> Array:
    """(n,) times from 0 to ``duration_s`` at which Cartesian motions are solved."""
    return np.linspace(0.0, duration_s, max(3, int(np.ceil(duration_s * KNOTS_PER_S)) + 1))


def follow(kinematics: Kinematics, arm: ArmState, t_s: Array, Ts_world_tcp: Array) -> Trajectory | None:
    """Trajectory through tcp poses (n, 4, 4) at ``t_s`` (n,) after ``arm.t_s``; None where IK cannot follow."""
    qs = kinematics.follow(Ts_world_tcp, arm.q, MAX_STEP_RAD)
    if qs is None:
        return None
    qs[0] = arm.q
    return Trajectory(arm.t_s + t_s, qs, speeds(qs, t_s, arm.qd))


def limit_ratio(trajectory: Trajectory, limits: JointLimits, from_s: float = 0.0, until_s: float = np.inf) -> float:
    """How many times as long a motion would have to take for its limits, in a span counted from its start.

    The largest joint speed over its limit, or the root of the largest acceleration over its own.
    """
    start_s = trajectory.start_s
    return times_too_fast(
        trajectory.t_s,
        trajectory.q,
        trajectory.qd,
        limits.velocity_rps,
        limits.acceleration_rps2,
        start_s + from_s,
        start_s + until_s,
    )
