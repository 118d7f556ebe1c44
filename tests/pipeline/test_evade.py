"""Making way: an arm in the way of the object leaves it in time, and only then."""

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.objects import load_object
from backend.pipeline.evade import WITHIN_S, WORTH_S, evade
from backend.pipeline.execute import ArmState
from backend.pipeline.rehearse import LOOK_EVERY_S, Rehearsal
from backend.pipeline.retime import JointLimits
from backend.pose import Array, Pose
from backend.sim.planning_scene import PlanningScene

KINEMATICS = load_kinematics("ur5_robotiq")
HOME = np.array(KINEMATICS.description.home_rad)
LIMITS = JointLimits(np.full(6, 0.35), np.full(6, 2.0))
STILL = np.zeros(6)
LOOKS = 30
TIMES_S: Array = LOOK_EVERY_S * np.arange(LOOKS, dtype=np.float64)
ALONG_MPS = 0.2


def towards(q: Array, arrives_s: float):
    """An object that comes from far away to where the tcp is at posture ``q`` then, and goes on towards the base."""
    at = KINEMATICS.fk(q)[:3, 3]
    outwards = np.array([at[0], at[1], 0.0]) / np.hypot(at[0], at[1])

    def object_at(t_s: Array) -> Array:
        Ts = np.tile(np.eye(4), (len(t_s), 1, 1))
        Ts[:, :3, 3] = at + ALONG_MPS * (arrives_s - t_s)[:, None] * outwards
        return Ts

    return object_at


def rehearsal(*, wanted: bool = True) -> Rehearsal:
    scene = PlanningScene(KINEMATICS)
    scene.set_target(load_object("cube"), Pose.identity(), (0.1, 0.1, 0.02), Pose.identity())
    return Rehearsal(KINEMATICS, scene, LIMITS, lift_m=0.1, wanted=wanted)


@pytest.mark.parametrize("arrives_s", [1.5, 1.8, 2.1])
def test_an_arm_in_the_way_leaves_it_and_is_not_met(arrives_s: float):
    made = rehearsal()
    standing = np.tile(HOME, (LOOKS, 1))
    object_at = towards(HOME, arrives_s)
    assert made.meets(standing, object_at(TIMES_S)) is not None
    motion = evade(made, LIMITS, ArmState(HOME, STILL, 0.0), standing, object_at, HOME)
    assert motion is not None
    assert made.meets(motion.positions(TIMES_S), object_at(TIMES_S)) is None
    np.testing.assert_array_equal(motion.q[0], HOME)
    velocity, acceleration = motion.peaks()
    assert (velocity <= 1.001 * LIMITS.velocity_rps).all() and (acceleration <= 1.02 * LIMITS.acceleration_rps2).all()


def test_an_arm_that_is_not_in_the_way_stays_on_its_course():
    standing = np.tile(HOME, (LOOKS, 1))
    arm = ArmState(HOME, STILL, 0.0)
    for object_at in (towards(HOME, 20.0), towards(HOME, WITHIN_S + 1.5)):
        assert evade(rehearsal(), LIMITS, arm, standing, object_at, HOME) is None


def test_a_contact_that_cannot_be_avoided_is_put_off_as_far_as_it_is_worth():
    made = rehearsal()
    standing = np.tile(HOME, (LOOKS, 1))
    later: list[int] = []
    for fastest_rps in (0.02, 0.05, 0.1, 0.2):
        limits = JointLimits(np.full(6, fastest_rps), np.full(6, 2.0))
        for arrives_s in (1.0, 1.5, 2.0):
            object_at = towards(HOME, arrives_s)
            before = made.meets(standing, object_at(TIMES_S))
            motion = evade(made, limits, ArmState(HOME, STILL, 0.0), standing, object_at, HOME)
            after = None if motion is None else made.meets(motion.positions(TIMES_S), object_at(TIMES_S))
            if before is not None and after is not None:
                later.append(after[0] - before[0])
    assert later and min(later) >= WORTH_S / LOOK_EVERY_S


def test_nothing_is_evaded_without_rehearsals():
    standing = np.tile(HOME, (LOOKS, 1))
    arm = ArmState(HOME, STILL, 0.0)
    assert evade(rehearsal(wanted=False), LIMITS, arm, standing, towards(HOME, 2.0), HOME) is None
