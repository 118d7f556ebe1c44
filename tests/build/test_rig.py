"""The rig: attempts are repeatable, independent of each other, and fail for the right reasons."""

import numpy as np
import pytest

from backend.build.rig import Rig, RigSettings
from backend.knowledge.grasps import load_grasps
from backend.objects import load_object
from backend.pose import Pose
from backend.robots import ROBOTS
from backend.robots.models import load_model

DOWN = Pose.from_xyz_rpy((0.0, 0.0, 0.03), (np.pi, 0.0, 0.0))
QUICK = RigSettings(lift_s=0.4, hold_s=0.2)


def rig(robot: str, name: str, settings: RigSettings = QUICK) -> Rig:
    return Rig(load_model(robot), load_object(name), settings)


@pytest.mark.parametrize("robot", ROBOTS)
def test_an_attempt_does_not_depend_on_what_was_tried_before(robot: str):
    rng = np.random.default_rng(4)
    grasps = [Pose(T) for T in load_grasps(robot, "power_drill").Ts_object_grasp[:4]]
    draws = [
        (T, Pose.from_xyz_yaw((*rng.uniform(-0.01, 0.01, 2), 0.0), rng.uniform(-0.3, 0.3)), rng.uniform(-0.05, 0.05, 2))
        for T in grasps
    ]
    with rig(robot, "power_drill") as used:
        forwards = [used.attempt(*draw) for draw in draws]
        backwards = [used.attempt(*draw) for draw in draws[::-1]][::-1]
    with rig(robot, "power_drill") as fresh:
        alone = fresh.attempt(*draws[-1])
    assert forwards == backwards
    assert alone == forwards[-1]


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_good_grasp_holds_on_a_moving_belt(robot: str):
    with rig(robot, "cube", RigSettings()) as cubes:
        for velocity in ((0.0, 0.0), (0.05, 0.0), (0.0, -0.05)):
            attempted = cubes.attempt(DOWN, velocity_mps=np.array(velocity))
            assert attempted.held and attempted.slip_m < 0.01, (velocity, attempted)


def test_air_is_not_held():
    with rig("mico", "cube") as cubes:
        beside = Pose.from_xyz_rpy((0.3, 0.0, 0.1), (np.pi, 0.0, 0.0))
        assert cubes.attempt(beside).why == "the fingers do not hold it"


def test_an_object_beside_where_it_is_believed_is_missed():
    with rig("ur5_robotiq", "cube") as cubes:
        assert cubes.attempt(DOWN).held
        assert not cubes.attempt(DOWN, Pose.of((0.0, 0.12, 0.0))).held


def test_a_misplaced_object_is_the_same_as_a_misplaced_hand():
    shift = Pose.from_xyz_yaw((0.006, -0.004, 0.0), 0.2)
    with rig("ur5_robotiq", "mustard_bottle") as bottles:
        T = Pose(load_grasps("ur5_robotiq", "mustard_bottle").Ts_object_grasp[0])
        assert bottles.attempt(T, shift).held == bottles.attempt(shift.inverse() @ T).held


def test_a_hand_in_the_object_or_in_the_tray_is_not_clear():
    askew = Pose.from_xyz_rpy((0.0, 0.045, 0.03), (np.pi, 0.0, 0.0))
    deep = Pose.from_xyz_rpy((0.0, 0.0, -0.01), (np.pi, 0.0, 0.0))
    with rig("ur5_robotiq", "cube") as cubes:
        assert [cubes.is_clear(T) for T in (DOWN, askew, deep)] == [True, False, False]
