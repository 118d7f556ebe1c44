"""Cartesian motion as a joint trajectory: dense tcp poses followed by IK on one branch, within joint speeds."""

from dataclasses import dataclass

import numpy as np

from backend.kinematics import Kinematics
from backend.pose import Array
from backend.trajectory import Trajectory

KNOTS_PER_S = 60.0
MAX_STEP_RAD = 0.15
"""A larger change of any joint between two knots is a jump to another IK branch."""


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
    qs = qs.copy()
    qs[0] = arm.q
    qds = np.gradient(qs, t_s, axis=0)
    qds[0] = arm.qd
    return Trajectory(arm.t_s + t_s, qs, qds)


def speed_ratio(trajectory: Trajectory, velocity_rps: Array, from_s: float = 0.0, until_s: float = np.inf) -> float:
    """Largest joint speed between knots as a multiple of its limit (dof,), in a span counted from the start."""
    begin = trajectory.t_s[:-1] - trajectory.start_s
    speeds = np.abs(np.diff(trajectory.q, axis=0)) / np.diff(trajectory.t_s)[:, None] / velocity_rps
    return float(speeds[(begin >= from_s) & (begin < until_s)].max(initial=0.0))
