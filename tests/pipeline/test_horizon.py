"""How far ahead the object is predicted."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.kinematics import load_kinematics
from backend.methods.method import Intercept, StepHorizon
from backend.pipeline.execute import ArmState
from backend.pipeline.horizon import ANEW_S, IN_TIME_S, Underway, horizons_s, in_time
from backend.pipeline.retime import JointLimits, least_s
from backend.pose import Array, Pose

KINEMATICS = load_kinematics("ur5_robotiq")
MIDDLE = np.array([0.5, -1.1, 1.3, -1.7, -1.5, 0.2])
LIMITS = JointLimits(np.full(6, 1.0), np.full(6, 5.0))
T_MIDDLE = Pose(KINEMATICS.fk(MIDDLE))
"""Where pregrasps are when the object has come to the middle of its way."""


def moving(speed_mps: float, in_the_middle_s: float) -> Callable[[Array], Array]:
    """An object that crosses along y; its frame is that of the pregrasp."""

    def object_at(t_s: Array) -> Array:
        Ts = np.repeat(T_MIDDLE.matrix[None], len(t_s), axis=0)
        Ts[:, 1, 3] += speed_mps * (t_s - in_the_middle_s)
        return Ts

    return object_at


def underway(left_s: float = 1.0, gap_m: float = 0.5, q_end: Array = MIDDLE, q: Array = MIDDLE) -> Underway:
    return Underway(ArmState(q, np.zeros(6), 0.0), q_end, left_s, Pose.identity(), gap_m)


def horizons(config: StepHorizon | Intercept, way: Underway | None, object_at: Callable[[Array], Array]):
    return list(horizons_s(config, way, object_at, KINEMATICS, LIMITS))


@pytest.mark.parametrize(("gap_m", "ahead_s"), [(0.31, 2.0), (0.29, 1.0), (0.11, 1.0), (0.09, 0.0)])
def test_the_papers_steps(gap_m: float, ahead_s: float):
    assert horizons(StepHorizon(), underway(5.0, gap_m), moving(0.03, 5.0)) == [(ahead_s, False)]
    assert horizons(StepHorizon(), None, moving(0.03, 5.0)) == [(2.0, False)]


@given(st.floats(-1.0, 6.0))
def test_where_the_arm_will_be_in_time_they_meet_when_its_motion_ends(left_s: float):
    ahead_s, in_time_only = horizons(Intercept(longest_s=6.0), underway(left_s), moving(0.0, 0.0))[0]
    assert ahead_s == max(left_s, 0.0) and not in_time_only


def test_a_fast_object_is_met_where_the_arm_can_be_in_time():
    behind = moving(-0.25, 0.5)
    ahead_s, _ = horizons(Intercept(), underway(left_s=0.5, q=MIDDLE + 0.6), behind)[0]
    goal = KINEMATICS.ik(behind(np.array([ahead_s]))[0], MIDDLE)
    assert ahead_s > 0.5 and goal is not None
    assert least_s(MIDDLE + 0.6, np.zeros(6), goal[None], LIMITS)[0] <= ahead_s + IN_TIME_S


def test_what_can_be_met_nowhere_is_gone_to_when_the_motion_ends():
    assert horizons(Intercept(), underway(0.7), moving(3.0, -10.0))[0][0] == pytest.approx(0.7)


def test_where_there_is_nothing_to_go_on_with_the_earliest_times_come_first():
    assert horizons(Intercept(longest_s=5.0), None, moving(0.03, 5.0)) == [(s, True) for s in ANEW_S if s <= 5.0]
    assert horizons(Intercept(longest_s=0.5), None, moving(0.03, 5.0)) == [(0.5, True)]
    assert [s for s, _ in horizons(Intercept(), underway(0.3), moving(0.0, 0.0))][1:] == list(ANEW_S)


@pytest.mark.parametrize(("ahead_s", "arrives"), [(0.9, False), (1.3, True)])
def test_in_time_is_as_the_slowest_joint_has_it(ahead_s: float, arrives: bool):
    arm = ArmState(np.zeros(6), np.zeros(6), 0.0)
    assert in_time(arm, np.array([0.1, -1.0, 0.0, 0.2, 0.0, 0.0]), ahead_s, LIMITS) is arrives
