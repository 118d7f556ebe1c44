"""The last resort: come to rest as fast as the limits allow, wherever that is."""

from __future__ import annotations

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig
from ruckig import Trajectory as RuckigTrajectory

from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array
from backend.trajectory import Trajectory

JERK_TIME_S = 0.05
"""Time in which the acceleration may build up from zero to its limit."""
SAMPLES = 60


def stop(q: Array, qd: Array, limits: JointLimits, start_s: float) -> Trajectory:
    """Jerk-limited motion from ``q`` (dof,) rad at ``qd`` (dof,) rad/s to rest; it starts at ``start_s``."""
    if not np.abs(qd).max() > 0.0:
        return Trajectory.hold(q, start_s)
    dof = q.size
    parameters = InputParameter(dof)
    parameters.control_interface = ControlInterface.Velocity
    parameters.current_position = q.tolist()
    parameters.current_velocity = qd.tolist()
    parameters.current_acceleration = [0.0] * dof
    parameters.target_velocity = [0.0] * dof
    parameters.target_acceleration = [0.0] * dof
    parameters.max_acceleration = limits.acceleration_rps2.tolist()
    parameters.max_jerk = (limits.acceleration_rps2 / JERK_TIME_S).tolist()
    motion = RuckigTrajectory(dof)
    result = Ruckig(dof).calculate(parameters, motion)
    assert result in (Result.Working, Result.Finished), result
    t_s = np.linspace(0.0, float(motion.duration), SAMPLES)
    states = [motion.at_time(float(t)) for t in t_s]
    qs, qds = np.array([state[0] for state in states]), np.array([state[1] for state in states])
    qs[0], qds[0], qds[-1] = q, qd, 0.0
    return Trajectory(start_s + t_s, qs, qds)
