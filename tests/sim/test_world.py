"""The belt carries its load truly: in every task, from the first step on, for light and awkward objects."""

from dataclasses import replace

import numpy as np
import pytest

from backend.errors import InvalidInputError
from backend.events import MoveObstacle, SetBeltRate
from backend.scenario import scenario_names
from backend.sim.bullet import STEP_S, Bullet, Contact
from tests.sim.worlds import standing, world_of


def relative_error(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


@pytest.mark.parametrize("name", [n for n in scenario_names() if n.startswith("ur5")])
def test_tray_and_object_move_as_one_from_the_first_step_to_the_last(name: str):
    with world_of(name, "power_drill" if name.endswith("sinusoidal") else "tomato_soup_can") as world:
        arm = standing(world)
        start = world.tray_pose().inverse() @ world.object_pose()
        for k in range(int(world.setup.motion.duration_s / STEP_S) - 2):
            world.step(*arm)
            if k < 30 or k % 24 == 0:
                belt = world.conveyor.velocity_mps()
                assert relative_error(world.tray_velocity(), belt) < 0.01
                assert relative_error(world.object_velocity()[0], belt) < 0.01, f"step {k}"
        end = world.tray_pose().inverse() @ world.object_pose()
        assert np.linalg.norm(end.xyz_m - start.xyz_m) < 1e-3
        np.testing.assert_allclose(world.tray_pose().xyz_m, world.conveyor.pose.xyz_m, atol=1e-4)


@pytest.mark.parametrize("object_name", ["bleach_cleanser", "cube"])
def test_the_belt_changes_its_pace_without_losing_its_load(object_name: str):
    with world_of("mico_linear", object_name) as world:
        arm = standing(world)
        start = world.tray_pose().inverse() @ world.object_pose()
        for rate, seconds in ((3.0, 2.0), (0.0, 2.0), (-2.0, 2.0)):
            world.apply(SetBeltRate(rate=rate))
            before = world.object_pose().xyz_m
            for _ in range(int(seconds / STEP_S)):
                world.step(*arm)
            assert world.conveyor.rate == rate
            if rate == 0.0:
                assert np.linalg.norm(world.object_velocity()[0]) < 1e-4
            else:
                moved = (world.object_pose().xyz_m - before) @ world.conveyor.velocity_mps()
                assert moved > 0.0
        end = world.tray_pose().inverse() @ world.object_pose()
        assert np.linalg.norm(end.xyz_m - start.xyz_m) < 1e-3


def test_the_same_world_twice_is_the_same_bit_for_bit():
    def course() -> list[bytes]:
        with world_of("ur5_linear_obstacles", "mustard_bottle") as world:
            arm = standing(world)
            out: list[bytes] = []
            for _ in range(240):
                world.step(*arm)
                out.append(world.object_pose().matrix.tobytes() + world.q().tobytes())
            return out

    assert course() == course()


def test_the_arm_stands_still_when_it_is_told_to():
    with world_of("mico_circular", "cube") as world:
        arm = standing(world)
        for _ in range(480):
            world.step(*arm)
        np.testing.assert_allclose(world.q(), arm[0], atol=1e-3)


def test_an_obstacle_goes_where_it_is_put_and_stands_there():
    with world_of("mico_linear_obstacles", "cube") as world:
        arm = standing(world)
        world.apply(MoveObstacle(index=1, x_m=0.9, y_m=-0.8, yaw_rad=0.5))
        for _ in range(120):
            world.step(*arm)
        pose = world.obstacle_poses()[1]
        np.testing.assert_allclose(pose.xyz_m, (0.9, -0.8, 0.0), atol=2e-3)
        assert pose.yaw_rad == pytest.approx(0.5, abs=0.01)


def test_an_obstacle_that_is_not_there_cannot_be_moved():
    with world_of("mico_linear", "cube") as world:
        with pytest.raises(InvalidInputError, match="no obstacle 0; this scene has 0"):
            world.apply(MoveObstacle(index=0, x_m=0.5, y_m=0.5))


@pytest.mark.parametrize(
    ("distance_m", "share_of_force", "touches"), [(2e-4, 1.0, True), (2e-4, 0.0, False), (0.0, 0.0, True)]
)
def test_what_presses_on_the_object_touches_it_even_across_a_gap(
    monkeypatch: pytest.MonkeyPatch, distance_m: float, share_of_force: float, touches: bool
):
    """Bullet holds surfaces apart that press on each other: by up to 0.2 mm where a hand grips with 180 N."""
    contacts = Bullet.contacts

    def told(bullet: Bullet, *bodies: int) -> list[Contact]:
        real = contacts(bullet, *bodies)
        return [replace(c, distance_m=distance_m, normal_force_n=share_of_force * c.normal_force_n) for c in real]

    with world_of("ur5_linear", "cube") as world:
        world.step(*standing(world))
        monkeypatch.setattr(Bullet, "contacts", told)
        assert world.touching_object() == (set(), touches)
