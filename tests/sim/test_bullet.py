"""The door to PyBullet: frames, masses, ties, determinism, and what it says when misused."""

import math

import numpy as np
import pytest

from backend.errors import NotFoundError, SimulationError
from backend.objects import OBJECTS, load_object
from backend.pose import Array, Pose, rotation_angle_rad
from backend.robots.models import load_model
from backend.sim.bullet import STEP_S, Bullet, GripperDrive

TILTED = Pose.from_xyz_rpy((0.3, -0.2, 1.5), (0.4, -0.7, 1.1))


@pytest.mark.parametrize("name", sorted(OBJECTS))
def test_an_objects_pose_is_that_of_its_own_frame(name: str):
    with Bullet() as bullet:
        body = bullet.add_object(load_object(name), TILTED)
        assert np.allclose(bullet.pose(body).matrix, TILTED.matrix, atol=1e-6)
        bullet.set_pose(body, Pose.identity())
        assert np.allclose(bullet.pose(body).matrix, np.eye(4), atol=1e-6)


@pytest.mark.parametrize("name", sorted(OBJECTS))
def test_a_free_object_falls_about_its_centre_of_mass(name: str):
    target = load_object(name)
    spin = np.array([0.0, 0.0, 2.0])
    with Bullet() as bullet:
        body = bullet.add_object(target, Pose.of((0.0, 0.0, 5.0)))
        bullet.set_velocity(body, np.cross(spin, -target.center_of_mass_m), spin)
        bullet.step(48)
        middle = bullet.pose(body).transform_points(target.center_of_mass_m[None])[0]
    fallen_m = 9.81 * STEP_S**2 * 48 * 49 / 2
    assert np.allclose(middle[:2], target.center_of_mass_m[:2], atol=2e-3)
    assert middle[2] == pytest.approx(5.0 + target.center_of_mass_m[2] - fallen_m, abs=2e-3)


def test_velocity_is_that_of_the_bodys_own_origin():
    linear, angular = np.array([0.1, 0.2, 0.3]), np.array([0.5, -1.0, 2.0])
    with Bullet() as bullet:
        body = bullet.add_object(load_object("power_drill"), TILTED)
        bullet.set_velocity(body, linear, angular)
        assert np.allclose(bullet.velocity(body), (linear, angular), atol=1e-9)


def test_principal_moments_turn_an_object_as_its_inertia_says():
    target = load_object("power_drill")
    momentum_0, momentum_1 = (_angular_momentum(target.inertia_kgm2, steps) for steps in (0, 60))
    assert np.allclose(momentum_0, momentum_1, atol=0.02 * np.linalg.norm(momentum_0))


def test_a_fixed_object_stays():
    with Bullet() as bullet:
        body = bullet.add_object(load_object("cube"), TILTED, fixed=True)
        bullet.step(60)
        assert np.allclose(bullet.pose(body).matrix, TILTED.matrix, atol=1e-6)


def test_a_box_slides_as_friction_says():
    """Friction 0.5 of both sides stops 1 m/s after v^2 / (2 mu g) (Coulomb)."""
    with Bullet() as bullet:
        bullet.add_floor()
        box = bullet.add_box((0.1, 0.1, 0.02), Pose.of((0.0, 0.0, 0.01)), mass_kg=0.5, friction=0.5)
        bullet.step(60)
        start_m = bullet.pose(box).xyz_m[0]
        bullet.set_velocity(box, np.array([1.0, 0.0, 0.0]), np.zeros(3))
        bullet.step(240)
        assert bullet.pose(box).xyz_m[0] - start_m == pytest.approx(1.0 / (2 * 0.5 * 9.81), rel=0.05)


def test_a_tied_body_follows_the_tie_within_a_tenth_of_a_millimetre():
    with Bullet() as bullet:
        body = bullet.add_box((0.1, 0.1, 0.02), Pose.of((0.0, 0.0, 0.5)), mass_kg=2.0)
        tie = bullet.tie_to_world(body, Pose.of((0.0, 0.0, 0.5)), 1e4)
        pose = Pose.identity()
        for k in range(1, 240):
            pose = Pose.from_xyz_yaw((0.05 * k * STEP_S, 0.0, 0.5), 0.3 * k * STEP_S)
            bullet.move_tie(tie, pose)
            bullet.step()
        assert np.allclose(bullet.pose(body).xyz_m, pose.xyz_m, atol=1e-4)
        assert rotation_angle_rad(bullet.pose(body).rotation, pose.rotation) < 1e-3
        assert np.allclose(bullet.velocity(body), ([0.05, 0.0, 0.0], [0.0, 0.0, 0.3]), atol=1e-3)


def test_contacts_name_links_and_weigh_what_rests_on_them():
    target = load_object("tomato_soup_can")
    with Bullet() as bullet:
        floor = bullet.add_floor()
        body = bullet.add_object(target, Pose.of((0.0, 0.0, 0.001)))
        other = bullet.add_box((0.1, 0.1, 0.1), Pose.of((1.0, 0.0, 0.05)))
        bullet.step(240)
        contacts = bullet.contacts(body)
        assert {(c.body_a, c.link_a, c.body_b, c.link_b) for c in contacts} <= {
            (body, "", floor, ""),
            (floor, "", body, ""),
        }
        weight_n = sum(c.normal_force_n for c in contacts)
        assert weight_n == pytest.approx(target.mass_kg * 9.81, rel=0.05)
        assert bullet.contacts(body, other) == []


def test_distance_is_measured_or_none():
    with Bullet() as bullet:
        a = bullet.add_box((0.1, 0.1, 0.1), Pose.of((0.0, 0.0, 0.0)))
        b = bullet.add_box((0.1, 0.1, 0.1), Pose.of((0.15, 0.0, 0.0)))
        assert bullet.closest_distance_m(a, b, 0.1) == pytest.approx(0.05, abs=1e-4)
        assert bullet.closest_distance_m(a, b, 0.04) is None
        bullet.set_pose(b, Pose.of((0.08, 0.0, 0.0)))
        assert bullet.closest_distance_m(a, b, 0.1) == pytest.approx(-0.02, abs=1e-3)


def test_ignored_contacts_let_bodies_pass():
    with Bullet() as bullet:
        floor = bullet.add_floor()
        box = bullet.add_box((0.1, 0.1, 0.1), Pose.of((0.0, 0.0, 0.06)), mass_kg=1.0)
        bullet.ignore_contacts(box, "", floor, "")
        bullet.step(120)
        assert bullet.pose(box).xyz_m[2] < -0.5


def test_an_unknown_link_names_the_known_ones():
    with Bullet() as bullet:
        robot = bullet.add_robot(load_model("mico"), np.array(load_model("mico").description.home_rad), 0.0)
        with pytest.raises(NotFoundError, match=r"no link named 'm1n6s200_link_66'.*m1n6s200_link_6"):
            robot.link_pose("m1n6s200_link_66")


def test_a_closed_world_says_so():
    bullet = Bullet()
    bullet.close()
    bullet.close()
    with pytest.raises(SimulationError, match="closed"):
        bullet.step()


@pytest.mark.parametrize("name", ["mico", "ur5_robotiq"])
def test_the_same_calls_give_the_same_bits(name: str):
    first, second = _grip_history(name), _grip_history(name)
    assert first.tobytes() == second.tobytes()
    assert np.ptp(first, axis=0).max() > 0.01


def test_worlds_do_not_disturb_each_other():
    alone = _grip_history("mico")
    with Bullet() as other:
        other.add_floor()
        other.add_box((0.1, 0.1, 0.1), Pose.of((0.0, 0.0, 0.4)), mass_kg=1.0)
        assert _grip_history("mico").tobytes() == alone.tobytes()


def test_the_drive_ramps_at_the_hands_speed_and_stops_at_its_limits():
    gripper = load_model("mico").description.gripper
    drive = GripperDrive(gripper)
    assert drive.update(0.1) == gripper.open_rad
    drive.close()
    assert drive.update(0.1) == pytest.approx(gripper.open_rad + 0.1 * gripper.close_speed_rps)
    assert drive.update(10.0) == pytest.approx(gripper.closed_rad)
    drive.open()
    assert drive.update(0.1) == pytest.approx(gripper.closed_rad - 0.1 * gripper.close_speed_rps)
    assert drive.update(10.0) == pytest.approx(gripper.open_rad)


def _angular_momentum(inertia: Array, steps: int) -> Array:
    with Bullet() as bullet:
        body = bullet.add_object(load_object("power_drill"), TILTED)
        bullet.set_velocity(body, np.zeros(3), np.array([1.0, 2.0, -1.5]))
        bullet.step(steps)
        R = bullet.pose(body).rotation
        return R @ inertia @ R.T @ bullet.velocity(body)[1]


def _grip_history(name: str) -> Array:
    """Pose of a box and all joints at every tenth step of a grip and a lift."""
    model = load_model(name)
    down = Pose.from_xyz_rpy((0.0, 0.0, 0.025), (math.pi, 0.0, 0.0))
    with Bullet() as bullet:
        bullet.add_floor()
        box = bullet.add_box((0.05, 0.05, 0.05), Pose.of((0.002, 0.001, 0.025)), mass_kg=0.2, friction=0.7)
        hand = bullet.add_hand(model, down)
        drive = GripperDrive(model.description.gripper)
        drive.close()
        rows: list[Array] = []
        for k in range(240):
            hand.move_to(Pose.of((0.0, 0.0, max(0.0, k - 150) * 1e-3)) @ down)
            hand.command_gripper(drive.update(STEP_S))
            bullet.step()
            if k % 10 == 0:
                rows.append(np.append(bullet.pose(box).matrix.ravel(), list(hand.joints_rad().values())))
    return np.array(rows)
