"""Symmetries of objects, and images of attempts: against distances, frames and physics."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from backend.build.attempts import Attempts
from backend.build.hand_points import hand_points
from backend.build.motion_data import AttemptSettings, attempted, columns, draw, make_rig, source_of
from backend.build.motion_images import believed_at, images
from backend.build.object_field import ObjectField, distance_at
from backend.build.symmetries import TURNS, Symmetries, symmetries
from backend.knowledge.grasps import load_grasps
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots.models import load_model


@cache
def alike(name: str) -> Symmetries:
    return symmetries(load_object(name))


def attempts(robot: str, name: str, count: int = 40) -> Attempts:
    """Draws of which none was tried."""
    cases = [draw(source_of(load_grasps(robot, name), 0), index) for index in range(count)]
    return columns(cases, [(False, "not tried")] * count)


@pytest.mark.parametrize(
    ("name", "turns_deg"), [("cube", [0, 90, 180, 270]), ("sugar_box", [0, 180]), ("bleach_cleanser", [0])]
)
def test_boxes_are_alike_by_right_angles_and_a_bottle_with_a_handle_only_mirrored(name: str, turns_deg: list[int]):
    known = alike(name)
    for mirrored in (False, True):
        np.testing.assert_allclose(np.degrees(known.turns_rad[known.mirrored == mirrored]), turns_deg)


def test_a_can_is_alike_from_everywhere_and_the_first_symmetry_leaves_all_as_it_is():
    known = alike("tomato_soup_can")
    assert len(known) == 2 * TURNS and known.mirrored.sum() == TURNS
    assert known.turns_rad[0] == 0.0 and not known.mirrored[0]


@pytest.mark.parametrize(("robot", "name"), [("ur5_robotiq", "tomato_soup_can"), ("ur5_robotiq", "cube")])
def test_in_an_image_every_point_of_the_hand_is_as_far_from_the_object(robot: str, name: str):
    field, points = ObjectField.of(load_object(name)).arrays, hand_points(load_model(robot))[::40]
    drawn, known = attempts(robot, name, 6), alike(name)

    def distances(T: Array, hand: Array) -> Array:
        places = hand @ T[:3, :3].T + T[:3, 3]
        return np.array([min(distance_at(field, *place), 0.04) for place in places])

    for k in range(0, len(known), 5):
        Ts, _ = known.images(drawn.Ts_object_grasp, drawn.direction_rad, np.full(6, k))
        seen = points * [-1.0, 1.0, 1.0] if known.mirrored[k] else points
        for T, image in zip(drawn.Ts_object_grasp, Ts, strict=True):
            off_m = np.abs(distances(T, points) - distances(image, seen))
            assert np.linalg.det(image[:3, :3]) == pytest.approx(1.0)
            assert np.quantile(off_m, 0.95) < 0.002


def test_an_images_motion_is_the_same_to_the_hand():
    drawn, known = attempts("ur5_robotiq", "cube"), alike("cube")
    which = np.arange(len(drawn)) % len(known)
    Ts, directions = known.images(drawn.Ts_object_grasp, drawn.direction_rad, which)

    def seen_from_hand(Ts: Array, direction_rad: Array) -> Array:
        ways = np.stack([np.cos(direction_rad), np.sin(direction_rad), np.zeros(len(Ts))], axis=1)
        return np.einsum("nji,nj->ni", Ts[:, :3, :3], ways)

    expected = seen_from_hand(drawn.Ts_object_grasp, drawn.direction_rad)
    expected[known.mirrored[which], 0] *= -1.0
    np.testing.assert_allclose(seen_from_hand(Ts, directions), expected, atol=1e-9)


def test_believed_elsewhere_the_true_grasp_and_motion_are_the_same():
    drawn = attempts("mico", "cube")
    elsewhere = np.random.default_rng(1).uniform(-0.1, 0.1, (len(drawn), 3))
    Ts, directions = believed_at(drawn, elsewhere)
    for k in range(len(drawn)):
        before, after = (Pose.from_xyz_yaw((*at[:2], 0.0), float(at[2])) for at in (drawn.misplaced[k], elsewhere[k]))
        true = before.inverse().matrix @ drawn.Ts_object_grasp[k]
        np.testing.assert_allclose(after.inverse().matrix @ Ts[k], true, atol=1e-12)
    np.testing.assert_allclose(directions - elsewhere[:, 2], drawn.direction_rad - drawn.misplaced[:, 2])
    Ts, directions = believed_at(drawn, drawn.misplaced)
    np.testing.assert_allclose(Ts, drawn.Ts_object_grasp, atol=1e-12)
    np.testing.assert_allclose(directions, drawn.direction_rad)


def test_without_symmetries_and_new_beliefs_an_attempt_is_its_only_image():
    drawn, rng = attempts("mico", "power_drill"), np.random.default_rng(0)
    Ts, directions = images(drawn, alike("power_drill"), AttemptSettings(), 0.0, rng)
    np.testing.assert_array_equal(Ts, drawn.Ts_object_grasp)
    np.testing.assert_array_equal(directions, drawn.direction_rad)


def test_physics_ends_images_of_attempts_as_the_attempts():
    robot, name = "ur5_robotiq", "mustard_bottle"
    source, known = source_of(load_grasps(robot, name), 0), alike(name)
    assert len(known) == 4 and known.mirrored[-1]
    cases = [case for case in (draw(source, index) for index in range(60)) if case.variant][:16]
    ends: list[tuple[bool, bool]] = []
    with make_rig(robot, name) as rig:
        for case in cases:
            ((T,), _) = known.images(case.T_object_grasp.matrix[None], np.zeros(1), np.array([3]))
            turn, flip = float(known.turns_rad[3]), np.array([1.0, -1.0])
            cos, sin = np.cos(turn), np.sin(turn)
            onto = np.array([[cos, -sin], [sin, cos]])
            x_y = onto @ (case.misplaced[:2] * flip)
            misplaced = np.array([*x_y, -case.misplaced[2]])
            image = replace(
                case, T_object_grasp=Pose(T), misplaced=misplaced, velocity_mps=onto @ (case.velocity_mps * flip)
            )
            ends.append((attempted(rig, case)[0], attempted(rig, image)[0]))
    assert 0 < sum(held for held, _ in ends) < len(ends)
    assert sum(a == b for a, b in ends) >= len(ends) - 1
