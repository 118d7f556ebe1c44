"""Reach profile: against a field in closed form, and against the real one asked directly."""

import numpy as np
import pytest

from backend.knowledge.reach_profile import GRASP_KINDS, GraspKind, profile_of
from backend.knowledge.reachability import load_reachability
from backend.pose import Array


class LeaningBall:
    """A ball of reach about the base, smaller by a tenth of a metre for the worst of directions and turns."""

    def signed_distance(self, Ts_world_tcp: Array) -> Array:
        worse = 0.05 * (1.0 - Ts_world_tcp[:, 0, 0]) + 0.05 * (Ts_world_tcp[:, 2, 2] > -0.5)
        return 0.8 - np.linalg.norm(Ts_world_tcp[:, :3, 3], axis=1) - worse


def test_the_best_turn_counts_at_each_radius_and_height():
    profile = profile_of(LeaningBall())
    for kind, worse in zip(GRASP_KINDS, (0.0, 0.05), strict=True):
        for height_m in (0.0, 0.07, 0.5):
            expected = 0.8 - np.hypot(profile.radius_m, height_m) - worse
            np.testing.assert_allclose(profile.at(kind, height_m), expected, atol=0.01)


def test_a_height_beyond_the_profile_is_its_edge():
    profile = profile_of(LeaningBall())
    top_m = float(profile.height_m[-1])
    np.testing.assert_array_equal(profile.at("From above", top_m + 1.0), profile.at("From above", top_m))
    np.testing.assert_array_equal(profile.at("From above", -1.0), profile.at("From above", 0.0))


@pytest.mark.parametrize("robot", ["mico", "ur5_robotiq"])
@pytest.mark.parametrize("kind", GRASP_KINDS)
def test_the_profile_says_what_the_best_of_many_grasps_of_the_kind_says(robot: str, kind: GraspKind):
    field, rng = load_reachability(robot), np.random.default_rng(3)
    profile = profile_of(field)
    best_m = np.full(60, -np.inf)
    places = rng.uniform((0.1, 0.1), (1.1, 0.6), (60, 2))
    for _ in range(200):
        about, roll = rng.uniform(0.0, 2.0 * np.pi, 2)
        level = np.array([np.cos(about), np.sin(about), 0.0])
        z_axis = np.array([0.0, 0.0, -1.0]) if kind == "From above" else level
        side = np.cross(z_axis, level if kind == "From above" else np.array([0.0, 0.0, 1.0]))
        x_axis = np.cos(roll) * side + np.sin(roll) * np.cross(z_axis, side)
        Ts = np.tile(np.eye(4), (len(places), 1, 1))
        Ts[:, :3, :3] = np.column_stack([x_axis, np.cross(z_axis, x_axis), z_axis])
        Ts[:, 0, 3], Ts[:, 2, 3] = places.T
        best_m = np.maximum(best_m, field.signed_distance(Ts))
    said = [np.interp(radius_m, profile.radius_m, profile.at(kind, height_m)) for radius_m, height_m in places]
    gap_m = best_m - np.array(said)
    assert np.abs(np.median(gap_m)) < 0.015 and np.percentile(np.abs(gap_m), 90) < 0.06
