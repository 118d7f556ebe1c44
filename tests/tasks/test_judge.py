"""The judge is not taken in: a raised tray is no lift, a knock is seen, a fall is seen, and each has its name."""

import numpy as np

from backend.events import MoveObstacle, SetBeltRate
from backend.pose import Pose
from backend.scenario import load_scenario, with_overrides
from backend.sim.world import World
from backend.tasks.judge import Judge
from tests.sim.worlds import standing, world_of


def rising_tray() -> World:
    """A belt that carries an object up by 20 cm, with nobody touching it."""
    heights = ["task.start_height_m=0.1", "task.end_height_m=0.3", "task.speed_mps=0.2"]
    return world_of(with_overrides(load_scenario("ur5_linear_z"), heights), "cube")


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds * 240)):
        world.step(*standing(world))


def test_an_untouched_object_on_a_rising_tray_passes_the_authors_rule_only():
    with rising_tray() as world:
        judge = Judge(world)
        judge.note_grasp(world)
        run(world, 4.0)
        judge.note_height(world)
        outcome = judge.verdict(world, None, "")
        assert outcome.authors and not outcome.strict
        assert outcome.reason == "dropped" and "not held by the hand alone" in outcome.detail


def test_a_lost_object_is_said_to_have_ended_below_its_grasp_when_it_did():
    with rising_tray() as world:
        run(world, 2.0)
        judge = Judge(world)
        judge.note_grasp(world)
        run(world, 2.0)
        judge.note_height(world)
        world.apply(SetBeltRate(rate=-2.0))
        run(world, 4.0)
        outcome = judge.verdict(world, None, "")
        assert outcome.reason == "dropped" and "cm below where it was grasped" in outcome.detail


def test_a_hand_that_closes_beside_the_object_has_missed():
    with world_of("ur5_linear", "cube") as world:
        judge = Judge(world)
        judge.note_grasp(world)
        run(world, 0.5)
        judge.note_height(world)
        assert judge.verdict(world, None, "").reason == "approach_missed"


def test_an_obstacle_that_moved_is_knocked_unless_people_moved_it():
    with world_of("mico_linear_obstacles", "cube") as world:
        judge = Judge(world)
        assert judge.knocked(world) is None
        world.apply(MoveObstacle(index=0, x_m=1.0, y_m=1.0))
        knocked = judge.knocked(world)
        assert knocked is not None and knocked.startswith(world.setup.obstacles[0][0])
        judge.obstacle_moved(0, world.obstacle_poses()[0])
        assert judge.knocked(world) is None


def test_an_obstacle_may_tremble_but_not_tilt():
    with world_of("mico_linear_obstacles", "cube") as world:
        judge = Judge(world)
        pose = world.obstacle_poses()[2]
        judge.obstacle_moved(2, Pose.of((0.019, 0.0, 0.0)) @ pose)
        assert judge.knocked(world) is None
        judge.obstacle_moved(2, pose @ Pose.from_xyz_rpy((0.0, 0.0, 0.0), (np.radians(11.0), 0.0, 0.0)))
        assert judge.knocked(world) is not None


def test_an_object_on_its_belt_has_not_fallen():
    with world_of("ur5_linear", "mustard_bottle") as world:
        judge = Judge(world)
        run(world, 1.0)
        assert not judge.fallen(world)


def test_why_a_trial_was_cut_short_is_kept():
    with world_of("ur5_linear", "cube") as world:
        outcome = Judge(world).verdict(world, "belt_end", "The belt came to its end.")
        assert (outcome.strict, outcome.reason, outcome.detail) == (False, "belt_end", "The belt came to its end.")
