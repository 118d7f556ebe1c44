"""Laws of retiming, with toppra as the judge of how fast it could be."""

import numpy as np
import pytest

from backend.methods.method import Fast, Toppra
from backend.pipeline.execute.cartesian import limit_ratio
from backend.pipeline.retime import JointLimits, retime, stop
from backend.pipeline.values import Refusal
from backend.pose import Array
from backend.trajectory import Path, Trajectory

LIMITS = {
    "paper": JointLimits(np.full(6, 0.315), np.full(6, 3.15)),
    "datasheet": JointLimits(np.full(6, 3.15), np.full(6, 6.3)),
}


@pytest.fixture(params=sorted(LIMITS))
def limits(request: pytest.FixtureRequest) -> JointLimits:
    return LIMITS[request.param]


def random_path(rng: np.random.Generator) -> Path:
    scale = rng.choice([0.05, 0.3, 0.8])
    return Path(np.cumsum(rng.normal(scale=scale, size=(rng.integers(2, 6), 6)), axis=0))


def random_velocity(rng: np.random.Generator, limits: JointLimits, share: float) -> Array:
    direction = rng.uniform(-1.0, 1.0, 6)
    return direction / np.abs(direction).max() * share * limits.velocity_rps


def peak_acceleration(trajectory: Trajectory) -> Array:
    """(dof,) largest acceleration of the cubics between the nodes; it is linear, so largest at their ends."""
    h = np.diff(trajectory.t_s)[:, None]
    mean = np.diff(trajectory.q, axis=0) / h
    v0, v1 = trajectory.qd[:-1], trajectory.qd[1:]
    ends = np.concatenate([(6 * mean - 4 * v0 - 2 * v1) / h, (-6 * mean + 2 * v0 + 4 * v1) / h])
    return np.abs(ends).max(axis=0)


def peak_velocity(trajectory: Trajectory) -> Array:
    times = np.linspace(trajectory.start_s, trajectory.end_s, 1500)[:-1]
    return np.abs([trajectory.sample(t)[1] for t in times]).max(axis=0)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9, 1.0])
def test_limits_hold_and_ends_are_exact_from_any_velocity(limits: JointLimits, share: float):
    rng = np.random.default_rng(int(10 * share))
    for _ in range(25):
        path, qd = random_path(rng), random_velocity(rng, limits, share)
        trajectory = retime(path, qd, limits, 2.5, Fast())
        assert isinstance(trajectory, Trajectory), trajectory
        assert trajectory.start_s == 2.5 and (np.diff(trajectory.t_s) > 0.0).all()
        assert np.array_equal(trajectory.q[0], path.waypoints[0])
        assert np.array_equal(trajectory.q[-1], path.waypoints[-1])
        assert np.array_equal(trajectory.qd[0], qd) and not trajectory.qd[-1].any()
        assert (peak_velocity(trajectory) <= 1.005 * limits.velocity_rps).all()
        assert (peak_acceleration(trajectory) <= 1.05 * limits.acceleration_rps2).all()


def test_it_is_as_fast_as_toppra(limits: JointLimits):
    rng = np.random.default_rng(4)
    for _ in range(6):
        path = random_path(rng)
        ours = retime(path, np.zeros(6), limits, 0.0, Fast())
        theirs = retime(path, np.zeros(6), limits, 0.0, Toppra())
        assert isinstance(ours, Trajectory) and isinstance(theirs, Trajectory)
        assert ours.end_s == pytest.approx(theirs.end_s, rel=0.03)


def test_from_rest_it_keeps_close_to_the_path(limits: JointLimits):
    rng = np.random.default_rng(5)
    path = random_path(rng)
    trajectory = retime(path, np.zeros(6), limits, 0.0, Fast())
    assert isinstance(trajectory, Trajectory)
    edges = [np.linspace(a, b, 400) for a, b in zip(path.waypoints[:-1], path.waypoints[1:], strict=True)]
    gaps = np.linalg.norm(trajectory.q[:, None] - np.concatenate(edges)[None], axis=2).min(axis=1)
    assert gaps.max() < 0.035


def test_a_path_of_one_point_is_held_or_braked_to(limits: JointLimits):
    point = Path(np.zeros((1, 6)))
    held = retime(point, np.zeros(6), limits, 1.0, Fast())
    assert isinstance(held, Trajectory) and not held.q.any()
    braked = retime(point, 0.5 * limits.velocity_rps, limits, 1.0, Fast())
    assert isinstance(braked, Trajectory) and not braked.q[-1].any()


def test_a_motion_that_touches_is_refused(limits: JointLimits):
    path = Path(np.array([np.zeros(6), np.ones(6), np.array([1.0, 0, 0, 0, 0, 0])]))
    everything_blocked = retime(path, np.zeros(6), limits, 0.0, Fast(), free=lambda qs: qs[:, 0] < 0.5)
    assert everything_blocked == Refusal("the rounded path touches something")
    assert isinstance(retime(path, np.zeros(6), limits, 0.0, Fast(), free=lambda qs: qs[:, 0] > -1.0), Trajectory)


def test_bad_input_is_refused_in_words(limits: JointLimits):
    path = Path(np.array([np.zeros(6), np.ones(6)]))
    none = JointLimits(np.zeros(6), limits.acceleration_rps2)
    assert retime(path, np.zeros(6), none, 0.0, Fast()) == Refusal("joint limits must be positive and finite")
    too_fast = retime(path, 1.5 * limits.velocity_rps, limits, 0.0, Fast())
    assert too_fast == Refusal("joint 1 moves at 1.50 times its velocity limit")
    broken = Path(np.full((2, 6), np.nan))
    assert retime(broken, np.zeros(6), limits, 0.0, Fast()) == Refusal("path and velocity must be finite")


def test_a_stop_comes_to_rest_within_limits(limits: JointLimits):
    q, qd = np.arange(6.0), random_velocity(np.random.default_rng(1), limits, 0.9)
    halt = stop(q, qd, limits, 3.0)
    assert halt.start_s == 3.0 and np.array_equal(halt.q[0], q) and np.array_equal(halt.qd[0], qd)
    assert not halt.qd[-1].any()
    assert (peak_velocity(halt) <= 1.001 * np.abs(qd)).all()
    assert (peak_acceleration(halt) <= 1.05 * limits.acceleration_rps2).all()


def test_the_limit_ratio_is_how_much_slower_a_motion_would_have_to_be(limits: JointLimits):
    qs, slow = np.zeros((3, 6)), np.zeros((3, 6))
    qs[1, 2], qs[2, 2] = 0.5 * limits.velocity_rps[2], 1.0 * limits.velocity_rps[2]
    passed = Trajectory(np.array([4.0, 5.0, 5.25]), qs, slow)
    lazy = JointLimits(limits.velocity_rps, np.full(6, 1e9))
    assert limit_ratio(passed, lazy) == pytest.approx(1.5 * 2.0)  # a cubic from rest to rest peaks at 1.5 x its mean
    assert limit_ratio(passed, lazy, until_s=1.0) == pytest.approx(1.5 * 0.5)
    for strength in (0.1, 1.0, 10.0):
        weak = JointLimits(np.full(6, 1e9), np.full(6, strength))
        ratio = limit_ratio(passed, weak)
        slower = Trajectory(4.0 + ratio * (passed.t_s - 4.0), qs, slow)
        assert limit_ratio(slower, weak) == pytest.approx(1.0)
