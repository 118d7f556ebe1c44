"""The filters that ask how grasps hold in motion: what they are told of the motion, what they keep, and R+M."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import PreparedGrasps
from backend.methods.method import (
    ConstantVelocity,
    FilterConfig,
    LastPose,
    MotionAware,
    Reachability,
    ReachabilityMotion,
)
from backend.pipeline.convert import convert
from backend.pipeline.filter import shortlist
from backend.pipeline.filter.motion_aware import OTHERS_HOLD_BETTER
from backend.pipeline.filter.ranking import PUT_OFF
from backend.pipeline.predict import make_predictor
from backend.pipeline.values import Observation, PlanarMotion, Prediction, Shortlist
from backend.pose import Pose
from tests.motion_models import drawn_model
from tests.pipeline.contexts import OBJECT, context_of

angles = st.floats(-np.pi, np.pi)


def prediction_of(T_begin: Pose, T_end: Pose, took_s: float) -> Prediction:
    Ts = np.array([T_begin.matrix, T_begin.matrix, T_end.matrix])
    return Prediction(np.array([0.0, 1.0, 1.0 + took_s]), Ts, np.zeros(3), np.zeros(3))


@given(heading=angles, yaw=angles, turn=st.floats(-1.0, 1.0), speed=st.floats(0.001, 0.1), took_s=st.floats(0.2, 3.0))
def test_the_direction_is_that_of_the_objects_own_frame(
    heading: float, yaw: float, turn: float, speed: float, took_s: float
):
    """An object that is turned by some yaw sees the world's heading turned back by as much."""
    begin = Pose.from_xyz_yaw((0.4, -0.2, 0.1), yaw)
    way = speed * took_s * np.array([np.cos(heading), np.sin(heading), 0.0])
    motion = prediction_of(begin, Pose.from_xyz_yaw(begin.xyz_m + way, yaw + turn), took_s).motion(1, 2)
    assert motion.speed_mps == pytest.approx(speed, rel=1e-6)
    off = motion.direction_rad - (heading - yaw)
    assert np.cos(off) == pytest.approx(1.0, abs=1e-9)


def test_only_the_level_part_of_a_motion_counts():
    begin = Pose.from_xyz_yaw((0.4, 0.0, 0.1), 0.3)
    motion = prediction_of(begin, Pose.from_xyz_yaw((0.4, 0.02, 0.4), 0.3), 1.0).motion(1, 2)
    assert motion.speed_mps == pytest.approx(0.02)


@pytest.mark.parametrize(("config", "speed_mps"), [(ConstantVelocity(), 0.03), (LastPose(), 0.0)])
def test_the_motion_is_the_predictors_not_the_truths(config: ConstantVelocity | LastPose, speed_mps: float):
    def forbidden(t_s: float) -> Pose:
        raise AssertionError("the truth was asked for")

    predictor = make_predictor(config, forbidden)
    for t_s in np.arange(0.0, 1.0, 0.05):
        T = Pose.from_xyz_yaw((0.5, 0.03 * t_s, 0.02), np.pi / 2)
        predictor.observe(Observation(float(t_s), np.zeros(6), np.zeros(6), T))
    prediction = predictor.predict(np.array([1.0, 3.0, 4.0]))
    assert prediction is not None
    motion = prediction.motion(1, 2)
    assert motion.speed_mps == pytest.approx(speed_mps, abs=1e-6)
    assert speed_mps == 0.0 or motion.direction_rad == pytest.approx(0.0, abs=1e-6)


def prepared() -> PreparedGrasps:
    return drawn_model("ur5_robotiq", OBJECT).over(load_grasps("ur5_robotiq", OBJECT).Ts_object_grasp)


def ranked(
    config: FilterConfig,
    x_m: float = 0.8,
    held: int | None = None,
    put_off: frozenset[int] = frozenset(),
    direction_rad: float = 0.7,
) -> Shortlist:
    grasps = load_grasps("ur5_robotiq", OBJECT)
    candidates = convert(grasps, Pose.from_xyz_yaw((x_m, 0.1, 0.02), 0.4), 0.075)
    return shortlist(config, candidates, context_of(held, put_off, prepared(), PlanarMotion(0.03, direction_rad)))


def check_whole(short: Shortlist) -> None:
    assert set(short.kept) | set(short.rejected) == set(range(len(short.score)))
    assert not set(short.kept) & set(short.rejected)
    assert len(set(short.kept)) == len(short.kept)
    assert all(short.rejected.values())


def test_the_likeliest_to_hold_are_kept_best_first():
    short = ranked(MotionAware(varied=False))
    check_whole(short)
    expected = prepared().quality(0.03, np.radians(40.0))  # 0.7 rad is 40.1 degrees
    assert short.motion_quality is not None
    np.testing.assert_allclose(short.motion_quality, expected, rtol=1e-12)
    assert list(short.kept) == np.argsort(-expected, kind="stable")[:10].tolist()
    assert set(short.rejected.values()) == {OTHERS_HOLD_BETTER}
    assert ranked(MotionAware(varied=False), direction_rad=0.7 + np.pi).kept != short.kept


@given(st.floats(0.0, 0.2), st.floats(-10.0, 10.0))
def test_a_motion_is_asked_about_once_and_answered_for_one_that_hardly_differs(speed_mps: float, direction_rad: float):
    grasps = prepared()
    answer = grasps.about(speed_mps, direction_rad)
    assert grasps.about(speed_mps, direction_rad + 2.0 * np.pi) is answer
    directions = direction_rad + np.radians([-0.5, 0.0, 0.5])
    speeds = np.maximum(speed_mps + np.array([-2.5e-4, 0.0, 2.5e-4]), 0.0)
    around = [grasps.quality(float(v), float(d)) for v in speeds for d in directions]
    assert (answer >= np.min(around, axis=0) - 0.02).all() and (answer <= np.max(around, axis=0) + 0.02).all()


def test_the_held_grasp_comes_first_and_a_refused_one_is_put_off():
    short = ranked(MotionAware())
    last, best = next(iter(short.rejected)), short.kept[0]
    again = ranked(MotionAware(), held=last, put_off=frozenset({best}))
    check_whole(again)
    assert again.kept[0] == last and again.rejected[best] == PUT_OFF


@pytest.mark.parametrize("x_m", [0.5, 0.8, 1.0, 1.6])
@pytest.mark.parametrize("held", [None, 3])
def test_r_and_m_is_both_top_fives_each_grasp_once(x_m: float, held: int | None):
    both = ranked(ReachabilityMotion(), x_m, held)
    by_reach = ranked(Reachability(keep=5), x_m, held)
    by_motion = ranked(MotionAware(keep=5), x_m)
    check_whole(both)
    assert set(both.kept) == set(by_reach.kept) | set(by_motion.kept)
    assert 5 <= len(both.kept) <= 10 and len(by_motion.kept) == 5
    assert both.reachability_m is not None and both.motion_quality is not None
    np.testing.assert_array_equal(both.reachability_m, by_reach.score)
    np.testing.assert_array_equal(both.motion_quality, by_motion.score)
    for i, why in both.rejected.items():
        assert why == f"{by_reach.rejected[i]}; {by_motion.rejected[i]}"


def test_r_and_m_keeps_the_held_grasp_first_while_it_is_reachable_and_puts_off_what_was_refused():
    free = ranked(ReachabilityMotion())
    assert free.reachability_m is not None
    reachable = [i for i in free.rejected if free.reachability_m[i] > 0.0]
    out = [i for i in free.rejected if free.reachability_m[i] <= 0.0]
    assert reachable and out
    assert ranked(ReachabilityMotion(), held=reachable[0]).kept[0] == reachable[0]
    assert out[0] not in ranked(ReachabilityMotion(), held=out[0]).kept
    refused = ranked(ReachabilityMotion(), put_off=frozenset(free.kept[:2]))
    check_whole(refused)
    assert all(refused.rejected[i] == PUT_OFF for i in free.kept[:2])


def test_grasps_on_both_lists_are_kept_once():
    half = 50
    by_reach, by_motion = ranked(Reachability(keep=half)), ranked(MotionAware(keep=half))
    on_both = set(by_reach.kept) & set(by_motion.kept)
    both = ranked(ReachabilityMotion(keep_each=half))
    check_whole(both)
    assert on_both and len(both.kept) == len(by_reach.kept) + len(by_motion.kept) - len(on_both)


def test_the_motion_changes_nothing_in_the_reach():
    a, b = ranked(ReachabilityMotion()), ranked(ReachabilityMotion(), direction_rad=-2.0)
    assert a.reachability_m is not None and b.reachability_m is not None
    np.testing.assert_array_equal(a.reachability_m, b.reachability_m)
    assert a.kept != b.kept
