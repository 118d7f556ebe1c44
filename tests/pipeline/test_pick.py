"""Pick: order, reasons, and the grasp that the arm is moving to; the retimed way is the oracle of what is near."""

import itertools

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.knowledge.grasps import load_grasps
from backend.methods.method import Fast
from backend.pipeline.convert import convert
from backend.pipeline.pick import pick_nearest
from backend.pipeline.retime import JointLimits, retime
from backend.pipeline.values import Candidate, Shortlist
from backend.pose import Pose
from backend.trajectory import Path, Trajectory
from tests.pipeline.contexts import context_of

KINEMATICS = load_kinematics("ur5_robotiq")
START = Pose.of((0.1, 0.55, 0.03))
LIMITS = JointLimits(np.full(6, 0.35), np.full(6, 3.5))


def all_of_it(T_world_object: Pose) -> Shortlist:
    candidates = convert(load_grasps("ur5_robotiq", "cube"), T_world_object, 0.05)
    count = len(candidates.Ts_object_grasp)
    return Shortlist(candidates, tuple(range(count)), np.zeros(count), {}, {})


@pytest.fixture(scope="module")
def short() -> Shortlist:
    return all_of_it(START)


def lasts_s(candidate: Candidate) -> float:
    """The straight way to the pregrasp, retimed."""
    path = Path(np.array([context_of(None, frozenset()).q, candidate.goals[0].q_pregrasp]))
    trajectory = retime(path, np.zeros(6), LIMITS, 0.0, Fast())
    assert isinstance(trajectory, Trajectory)
    return trajectory.end_s


def test_what_is_nearer_is_reached_sooner(short: Shortlist):
    picked, _ = pick_nearest(short, context_of(None, frozenset()))
    ways = [candidate.joint_distance_rad for candidate in picked]
    assert len(picked) > 2 and ways == sorted(ways)
    compared = 0
    for near, far in itertools.combinations(picked, 2):
        if far.joint_distance_rad - near.joint_distance_rad > 0.4:
            compared += 1
            assert lasts_s(near) < lasts_s(far)
    assert compared


def test_goals_are_where_they_should_be_and_the_nearest_comes_first(short: Shortlist):
    picked, _ = pick_nearest(short, context_of(None, frozenset()))
    q = context_of(None, frozenset()).q
    for candidate in picked:
        ways = [np.abs(g.q_pregrasp - q).max() + np.abs(g.q_grasp - q).max() for g in candidate.goals]
        assert ways == sorted(ways) and candidate.joint_distance_rad == pytest.approx(ways[0])
        for goal in candidate.goals:
            np.testing.assert_allclose(KINEMATICS.fk(goal.q_pregrasp), candidate.T_world_pregrasp.matrix, atol=2e-3)
            np.testing.assert_allclose(KINEMATICS.fk(goal.q_grasp), candidate.T_world_grasp.matrix, atol=2e-3)


def test_the_grasp_under_way_is_not_left_for_a_trifle(short: Shortlist):
    free, _ = pick_nearest(short, context_of(None, frozenset()))
    near, next_ = free[0], free[1]
    assert next_.joint_distance_rad < near.joint_distance_rad / 0.7
    held, _ = pick_nearest(short, context_of(next_.index, frozenset()))
    assert held[0].index == next_.index


def test_what_is_out_of_reach_is_refused_in_words():
    far = all_of_it(Pose.of((0.0, 3.0, 0.03)))
    picked, refused = pick_nearest(far, context_of(None, frozenset()))
    assert picked == () and set(refused) == set(far.kept)
    assert set(refused.values()) == {"pregrasp out of reach"}
