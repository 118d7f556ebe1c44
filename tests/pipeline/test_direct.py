"""Direct motions: as quick as ruckig's, within the limits, and as long when they are begun again on the way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ruckig import InputParameter, Result, Ruckig
from ruckig import Trajectory as RuckigTrajectory

from backend.methods.method import Fast, Toppra
from backend.pipeline.retime import retime
from backend.pipeline.retime.direct import direct, least_s
from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array
from backend.trajectory import Path, Trajectory

DOF = 6
SEEDS = st.integers(0, 10_000)


def problem(seed: int) -> tuple[Array, Array, Array, JointLimits]:
    """Posture, velocity, goal and limits; near and far goals, some at rest, some faster than they can stop."""
    rng = np.random.default_rng(seed)
    limits = JointLimits(rng.uniform(0.3, 3.5, DOF), rng.uniform(1.0, 8.0, DOF))
    qd = rng.uniform(-1.0, 1.0, DOF) * limits.velocity_rps * (rng.random() < 0.9)
    q = rng.uniform(-2.0, 2.0, DOF)
    return q, qd, q + rng.normal(size=DOF) * 10.0 ** rng.uniform(-3.0, 0.5), limits


def ruckigs_s(q: Array, qd: Array, goal: Array, limits: JointLimits) -> float:
    """How long ruckig takes without a limit of jerk."""
    asked = InputParameter(DOF)
    asked.current_position, asked.current_velocity, asked.target_position = q.tolist(), qd.tolist(), goal.tolist()
    asked.max_velocity, asked.max_acceleration = limits.velocity_rps.tolist(), limits.acceleration_rps2.tolist()
    asked.max_jerk = [float("inf")] * DOF
    found = RuckigTrajectory(DOF)
    assert Ruckig(DOF).calculate(asked, found) in (Result.Working, Result.Finished)
    return float(found.duration)


@given(SEEDS)
def test_none_is_quicker(seed: int):
    q, qd, goal, limits = problem(seed)
    assert direct(q, qd, goal, limits).end_s == pytest.approx(ruckigs_s(q, qd, goal, limits), abs=6e-3)
    assert least_s(q, qd, goal[None], limits)[0] == pytest.approx(ruckigs_s(q, qd, goal, limits), rel=1e-6, abs=1e-9)


@given(SEEDS)
def test_it_begins_and_ends_as_asked_within_the_limits(seed: int):
    q, qd, goal, limits = problem(seed)
    motion = direct(q, qd, goal, limits)
    velocity, acceleration = motion.peaks()
    assert (velocity <= 1.0001 * limits.velocity_rps).all()
    assert (acceleration <= 1.03 * limits.acceleration_rps2).all()
    assert (motion.q[0] == q).all() and (motion.qd[0] == qd).all()
    assert (motion.q[-1] == goal).all() and not motion.qd[-1].any()
    near_the_end, slow = motion.sample(motion.end_s - 1e-6)
    assert np.abs(near_the_end - goal).max() < 1e-4 and np.abs(slow).max() < 1e-3


@given(SEEDS, st.floats(0.01, 0.99))
def test_begun_again_on_the_way_it_ends_hardly_later(seed: int, share: float):
    q, qd, goal, limits = problem(seed)
    motion = direct(q, qd, goal, limits)
    now_s = share * motion.end_s
    again = direct(*motion.sample(now_s), goal, limits)
    assert now_s + again.end_s <= motion.end_s + 0.02


def test_the_retimer_that_was_chosen_is_the_one_that_times():
    q, qd, goal, limits = problem(4)
    path = Path(np.stack([q, goal]))
    fast, toppra = (retime(path, qd, limits, 0.0, config) for config in (Fast(), Toppra()))
    assert isinstance(fast, Trajectory) and isinstance(toppra, Trajectory)
    assert fast.end_s == pytest.approx(ruckigs_s(q, qd, goal, limits), rel=0.04)
    assert toppra.end_s > fast.end_s and len(toppra.t_s) > len(fast.t_s)


def test_who_is_there_and_at_rest_stays():
    q = np.full(DOF, 0.5)
    motion = direct(q, np.zeros(DOF), q, JointLimits(np.ones(DOF), np.ones(DOF)))
    assert (motion.q == q).all() and not motion.qd.any() and motion.end_s > 0.0
