"""The hand's way as the grasp sees it: offsets that add up, and corrections that leave a slide's shape alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from backend.kinematics import load_kinematics
from backend.pipeline.execute import Approach, ApproachRequest, ArmState, correct_approach, plan_approach, plan_lift
from backend.pipeline.execute.cartesian import limit_ratio
from backend.pipeline.execute.relative_way import Offset, RelativeWay, as_state
from backend.pipeline.retime import JointLimits
from backend.pipeline.values import Refusal
from backend.pose import Array, Pose, inverse

KINEMATICS = load_kinematics("ur5_robotiq")
LIMITS = JointLimits(np.full(6, 0.315), np.full(6, 3.15))
HOME = np.array([-0.6, -1.4, 1.9, -2.1, -1.57, 0.3])
"""The hand looks down, half a metre from the base."""
T_OBJECT_GRASP = Pose(KINEMATICS.fk(HOME))
TURNING = np.array([0.03, 0.0, 0.0, 0.0, 0.0, 0.15])
"""How the hand moves, m/s, and turns, rad/s, as it rides along."""
states = arrays(np.float64, 6, elements=st.floats(-0.5, 0.5))


def standing(shift_m: float = 0.0, turn_rad: float = 0.0):
    """An object at the world's origin, or beside it."""

    def object_at(t_s: Array) -> Array:
        return np.tile(Pose.from_xyz_yaw((shift_m, 0.0, 0.0), turn_rad).matrix, (len(t_s), 1, 1))

    return object_at


def going_in() -> tuple[ApproachRequest, Approach]:
    """A slide as fast as the arm can, from the pregrasp."""
    T_pregrasp = T_OBJECT_GRASP @ Pose.of((0.0, 0.0, -0.1))
    q = KINEMATICS.ik(T_pregrasp.matrix, HOME)
    assert q is not None
    asked = ApproachRequest(ArmState(q, np.zeros(6), 0.0), standing(), T_OBJECT_GRASP, 0.1, 0.2, 0.5)
    approach = plan_approach(KINEMATICS, LIMITS, asked)
    assert isinstance(approach, Approach)
    return asked, approach


@given(states, states, states, st.floats(0.2, 3.0), st.floats(0.2, 3.0))
def test_offsets_add_up_and_end_at_the_grasp(a: Array, b: Array, rate: Array, a_s: float, b_s: float):
    way = RelativeWay((Offset(a, np.zeros(6), 1.0, 1.0 + a_s), Offset(b, rate, 1.0, 1.0 + b_s)))
    np.testing.assert_allclose(way.at(np.array([1.0]))[0], a + b, atol=1e-12)
    np.testing.assert_allclose(way.at(np.array([1.0 - 1e-3]))[0], a + b - 1e-3 * rate, atol=1e-12)
    np.testing.assert_allclose(way.at(np.array([1.0 + max(a_s, b_s), 9.0])), 0.0, atol=1e-9)


@given(states)
def test_a_state_is_its_pose(state: Array):
    T = RelativeWay((Offset(state, np.zeros(6), 0.0, 1.0),)).Ts_grasp_tcp(np.zeros(1))[0]
    np.testing.assert_allclose(T[:3, :3], Rotation.from_rotvec(state[3:]).as_matrix(), atol=1e-9)
    np.testing.assert_allclose(as_state(T), state, atol=1e-9)


def test_the_way_is_what_the_hand_does():
    asked, approach = going_in()
    t_s = np.linspace(0.0, approach.trajectory.end_s, 20)
    T_world_tcp = KINEMATICS.fk_many(approach.trajectory.positions(t_s))
    expected = asked.object_at(t_s) @ T_OBJECT_GRASP.matrix @ approach.way.Ts_grasp_tcp(t_s)
    np.testing.assert_allclose(T_world_tcp, expected, atol=1e-4)


def test_a_slide_at_the_arms_limit_takes_every_small_correction_and_arrives_when_it_was_to():
    """Twenty times a second, and in the end the hand is where the last prediction was."""
    asked, first = going_in()
    assert limit_ratio(first.trajectory, LIMITS) > 0.9
    rng = np.random.default_rng(0)
    approach, shift_m = first, 0.0
    for now_s in np.arange(first.slide_s + 0.05, first.arrive_s - 0.2, 0.05).tolist():
        shift_m = float(rng.normal(0.0, 1e-4))
        arm = ArmState(*approach.trajectory.sample(now_s), now_s)
        seen = replace(asked, arm=arm, object_at=standing(shift_m))
        corrected = correct_approach(KINEMATICS, LIMITS, seen, approach, approach.arrive_s)
        assert isinstance(corrected, Approach), f"{corrected.why} at {now_s} s"
        assert corrected.arrive_s == first.arrive_s
        approach = corrected
    q, qd = approach.trajectory.sample(approach.arrive_s)
    np.testing.assert_allclose(KINEMATICS.fk(q)[:3, 3], T_OBJECT_GRASP.xyz_m + np.array([shift_m, 0.0, 0.0]), atol=1e-5)
    np.testing.assert_allclose(qd, 0.0, atol=1e-2)


@pytest.mark.parametrize("left_s", [0.3, 0.0])
def test_a_correction_beyond_the_arm_is_refused_or_arrives_later(left_s: float):
    asked, approach = going_in()
    now_s = approach.arrive_s - left_s
    arm = ArmState(*approach.trajectory.sample(now_s), now_s)
    seen = replace(asked, arm=arm, object_at=standing(0.05, 0.1))
    assert isinstance(correct_approach(KINEMATICS, LIMITS, seen, approach, approach.arrive_s), Refusal)
    later = correct_approach(KINEMATICS, LIMITS, seen, approach, approach.arrive_s + 1.0)
    assert isinstance(later, Approach)
    assert approach.arrive_s < later.arrive_s <= approach.arrive_s + 1.0
    q, _ = later.trajectory.sample(later.arrive_s)
    np.testing.assert_allclose(KINEMATICS.fk(q), seen.object_at(np.zeros(1))[0] @ T_OBJECT_GRASP.matrix, atol=1e-3)


def test_a_hand_that_turns_with_its_object_turns_out_in_the_lift():
    """An object on a belt's bend turns: the lift may not stop the hand's turning from one moment to the next."""
    velocity: Array = np.asarray(np.linalg.solve(KINEMATICS.jacobian(HOME), TURNING), dtype=np.float64)
    lift = plan_lift(KINEMATICS, LIMITS, ArmState(HOME, velocity, 0.0), 0.1)
    assert not isinstance(lift, Refusal)
    before, after = KINEMATICS.fk_many(lift.positions(np.array([0.0, 1e-3])))
    turned = as_state(inverse(before) @ after)[3:] / 1e-3
    np.testing.assert_allclose(np.linalg.norm(turned), 0.15, rtol=0.05)
    start, end = KINEMATICS.fk_many(lift.positions(np.array([0.0, lift.end_s])))
    assert end[2, 3] - start[2, 3] == pytest.approx(0.1, abs=1e-3)
    about = Rotation.from_matrix(end[:3, :3] @ start[:3, :3].T).as_rotvec()
    np.testing.assert_allclose(about, [0.0, 0.0, 0.15 * 0.2], atol=2e-3)
