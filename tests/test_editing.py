"""Live edits act in the world, the belief and before the judge alike, or not at all."""

from collections.abc import Iterable

import numpy as np
import pytest

from backend.editing import Editing
from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.events import AddObstacle, MoveObstacle, RemoveObstacle, SetBeltRate, SetSlab, TimedEvent, WorldEvent
from backend.kinematics import load_kinematics
from backend.pose import Pose
from backend.scenario import Scenario, load_scenario
from backend.sim.planning_scene import PlanningScene
from backend.sim.world import World
from backend.snapshot import Snapshot
from backend.tasks.judge import Judge
from backend.tasks.slab import slab_above
from tests.sim.worlds import standing, world_of

DOWN_BEHIND = np.array([2.4, -1.2, 1.8, -2.2, -1.6, 0.0])
HERE = AddObstacle(object="sugar_box", x_m=0.9, y_m=-0.8, yaw_rad=0.4)


def edited(scenario: Scenario, events: Iterable[tuple[int, WorldEvent]]) -> Scenario:
    return scenario.model_copy(update={"events": tuple(TimedEvent(tick=tick, event=event) for tick, event in events)})


def course(scenario: Scenario, ticks: int) -> list[Snapshot]:
    with Episode(scenario, 3) as episode:
        return [snapshot for snapshot, _ in zip(episode.run(), range(ticks), strict=False)]


def stage(name: str) -> tuple[World, PlanningScene, Judge, Editing]:
    """A world with a belief that knows the target alone."""
    world = world_of(name, "tomato_soup_can")
    belief = PlanningScene(load_kinematics(world.model.description.name))
    belief.set_target(world.object, world.object_pose(), world.setup.tray_size_m, world.tray_pose())
    judge = Judge(world)
    return world, belief, judge, Editing(world, belief, judge)


def test_what_is_put_up_stands_there_and_what_is_taken_away_is_gone():
    world, _, judge, editing = stage("ur5_linear")
    with world:
        editing.act(HERE)
        editing.act(AddObstacle(object="cube", x_m=-0.9, y_m=0.8))
        for _ in range(120):
            world.step(*standing(world))
        assert world.obstacles == ("sugar_box", "cube") and judge.knocked(world) is None
        np.testing.assert_allclose(world.obstacle_poses()[0].xyz_m, (0.9, -0.8, 0.0), atol=2e-3)
        editing.act(RemoveObstacle(index=0))
        for _ in range(60):
            world.step(*standing(world))
        assert world.obstacles == ("cube",) and judge.knocked(world) is None
        np.testing.assert_allclose(world.obstacle_poses()[0].xyz_m, (-0.9, 0.8, 0.0), atol=2e-3)
        editing.act(MoveObstacle(index=0, x_m=-0.7, y_m=0.8))
        assert judge.knocked(world) is None


def test_the_judge_sees_that_an_added_obstacle_was_knocked():
    world, _, judge, editing = stage("ur5_linear")
    with world:
        editing.act(HERE)
        world.apply(MoveObstacle(index=0, x_m=0.95, y_m=-0.8, yaw_rad=0.4))  # behind the judge's back
        assert "sugar_box" in (judge.knocked(world) or "")


def test_the_planner_knows_of_every_edit():
    world, belief, _, editing = stage("ur5_linear")
    with world:
        x_m, y_m = -0.4, 0.4
        q = belief.kinematics.ik(Pose.from_xyz_rpy((x_m, y_m, 0.15), (np.pi, 0.0, 0.0)).matrix, DOWN_BEHIND)
        assert q is not None and belief.is_free(q)
        for event in (SetBeltRate(rate=0.5), HERE, AddObstacle(object="cube", x_m=-0.9, y_m=0.8)):
            editing.act(event)
            assert belief.is_free(q)
        editing.act(AddObstacle(object="bleach_cleanser", x_m=x_m, y_m=y_m))
        assert "bleach_cleanser" in belief.why_blocked(q)
        editing.act(RemoveObstacle(index=1))
        assert "bleach_cleanser" in belief.why_blocked(q), "those after it have moved up"
        editing.act(MoveObstacle(index=1, x_m=-0.9, y_m=0.8))
        assert belief.is_free(q)
        editing.act(MoveObstacle(index=1, x_m=x_m, y_m=y_m))
        editing.act(RemoveObstacle(index=1))
        assert belief.is_free(q)


def test_a_slab_hangs_for_planner_and_arm_alike_until_it_is_taken_away():
    world, belief, _, editing = stage("ur5_linear")
    with world:
        middle = slab_above(world.setup.motion, 0.4)
        under = PlanningScene(belief.kinematics)
        under.add_box(middle.size_m, middle.T_world_box)
        rng = np.random.default_rng(0)
        qs = rng.uniform(-np.pi, np.pi, size=(4000, 6))
        without = belief.free_many(qs)
        editing.act(SetSlab(height_m=0.4))
        assert world.slab is not None and world.slab.same(middle)
        expected = without & under.free_many(qs)
        assert (belief.free_many(qs) == expected).all() and expected.sum() < without.sum()
        editing.act(SetSlab(height_m=0.7))
        assert not (belief.free_many(qs) == expected).all()
        editing.act(SetSlab(height_m=None))
        assert world.slab is None and (belief.free_many(qs) == without).all()


@pytest.mark.parametrize("name", ["mico_linear", "mico_linear_z", "ur5_circular", "ur5_sinusoidal"])
def test_a_slab_hangs_level_above_the_belt(name: str):
    with world_of(name, "cube") as world:
        slab = slab_above(world.setup.motion, 0.4)
        path = world.setup.motion.path_world(60)
        underside_m = slab.T_world_box.xyz_m[2] - 0.5 * slab.size_m[2]
        assert underside_m == pytest.approx(path[:, 2].max() + 0.4)
        ends = slab.T_world_box.inverse().matrix @ np.vstack([path[[0, -1]].T, np.ones(2)])
        np.testing.assert_allclose(np.abs(ends[0]), 0.5 * slab.size_m[0], atol=1e-6)


def test_the_live_slab_of_a_straight_belt_hangs_where_the_task_hangs_its_own():
    with world_of("ur5_linear_slab", "cube") as world:
        assert world.slab is not None
        mine = slab_above(world.setup.motion, 0.4)
        np.testing.assert_allclose(mine.T_world_box.xyz_m, world.slab.T_world_box.xyz_m, atol=1e-9)
        np.testing.assert_allclose(mine.size_m, world.slab.size_m, atol=1e-9)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (MoveObstacle(index=0, x_m=1.0, y_m=1.0), "There is no obstacle 0; this scene has 0"),
        (RemoveObstacle(index=2), "There is no obstacle 2; this scene has 0"),
        (AddObstacle(object="cube", x_m=0.0, y_m=0.05), "The cube would stand in the arm"),
    ],
)
def test_what_cannot_be_is_refused_and_changes_nothing(event: WorldEvent, words: str):
    world, belief, _, editing = stage("ur5_linear")
    with world:
        for ask in (editing.check, editing.act):
            with pytest.raises(InvalidInputError, match=words):
                ask(event)
        assert world.obstacles == () and belief.is_free(world.q())


def test_nothing_is_put_into_what_stands_there():
    world, _, _, editing = stage("ur5_linear")
    with world:
        x_m, y_m, _ = world.object_pose().xyz_m.tolist()
        editing.act(HERE)
        with pytest.raises(InvalidInputError, match="The cube would stand in the sugar_box"):
            editing.act(AddObstacle(object="cube", x_m=0.91, y_m=-0.8))
        with pytest.raises(InvalidInputError, match="would stand in the tray"):
            editing.act(MoveObstacle(index=0, x_m=x_m, y_m=y_m))
        editing.act(MoveObstacle(index=0, x_m=0.92, y_m=-0.8, yaw_rad=0.4))
        for i in range(15):
            editing.act(AddObstacle(object="cube", x_m=-1.5 + 0.2 * i, y_m=1.8))
        with pytest.raises(InvalidInputError, match="16 obstacles already"):
            editing.act(AddObstacle(object="cube", x_m=1.9, y_m=1.8))


def test_an_object_that_nobody_knows_is_no_obstacle():
    with pytest.raises(ValueError, match=r"no object named 'sugar_bix'.*Did you mean 'sugar_box'"):
        AddObstacle(object="sugar_bix", x_m=1.0, y_m=0.0)


def test_an_edited_trial_repeats_bit_for_bit_and_its_snapshots_say_what_stands_around():
    events = [(5, HERE), (9, SetSlab(height_m=0.9)), (20, RemoveObstacle(index=0)), (30, SetSlab(height_m=None))]
    scenario = edited(load_scenario("ur5_linear"), events)
    first, second = course(scenario, 45), course(scenario, 45)
    for one, other in zip(first, second, strict=True):
        assert (one.q == other.q).all() and one.stands_as(other)
    assert [len(s.obstacles) for s in first] == [0] * 6 + [1] * 15 + [0] * 24
    assert [s.slab is not None for s in first] == [False] * 10 + [True] * 21 + [False] * 14
    assert not first[5].stands_as(first[6]) and not first[8].stands_as(first[12])


def test_a_trial_whose_file_asks_for_the_impossible_ends_with_the_reason():
    scenario = edited(load_scenario("ur5_linear"), [(4, AddObstacle(object="cube", x_m=0.0, y_m=0.05))])
    last = course(scenario, 100)[-1]
    assert last.outcome is not None and last.outcome.reason == "error"
    assert "The cube would stand in the arm" in last.outcome.detail


def test_an_obstacle_in_the_way_is_gone_around():
    """A slab that comes down on a running trial changes how the object is grasped, and the trial succeeds."""
    scenario = edited(load_scenario("ur5_linear"), [(30, SetSlab(height_m=0.4)), (31, HERE)])
    with Episode(scenario, 3) as episode:
        *_, last = episode.run()
    assert last.outcome is not None and last.outcome.strict, last.outcome
    assert last.slab is not None and last.obstacles == ("sugar_box",)
