"""Reachability: the chart and its laws, the fields that come with the project, and how broken files are answered."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from backend.build.reach_finish import is_up_to_date, source_digest, workspace_m
from backend.build.reach_measure import agreement, calibrated_shift
from backend.build.reach_oracle import Oracle, random_poses
from backend.build.reachability import ReachabilitySettings, build_reachability
from backend.errors import InvalidInputError, MissingResourceError, NotFoundError
from backend.kinematics import load_kinematics
from backend.kinematics.chain import matrix_of, row_of
from backend.knowledge import reachability as knowledge
from backend.knowledge.reach_chart import fill_coordinates, fill_row
from backend.knowledge.reachability import (
    METRES_PER_RADIAN,
    load_reachability,
    reachability_file,
    read_reachability,
    save_reachability,
)
from backend.pose import Array, Pose, rotation_angle_rad
from backend.robots import ROBOTS

SMALL = ReachabilitySettings(position_step_m=0.2, approach_step_rad=0.7, rolls=6, postures=20_000, halvings=1, walks=1)
ROBOT_NAMES = sorted(ROBOTS)


def poses(robot: str, seed: int, count: int) -> Array:
    rng = np.random.default_rng(seed)
    return random_poses(rng, count, workspace_m(load_reachability(robot)), 0.9, float(np.radians(115.0)))


def test_the_chart_is_undone_by_turning_back():
    x, row = np.empty(5), np.empty(12)
    for T in poses("ur5_robotiq", 0, 200):
        azimuth = fill_coordinates(row_of(T), x)
        fill_row(x, row)
        turned = Pose.from_xyz_yaw((0.0, 0.0, 0.0), azimuth).matrix @ matrix_of(row)
        np.testing.assert_allclose(turned, T, atol=1e-9)


def test_a_field_is_up_to_date_for_its_own_robot_seed_and_settings_only():
    mico, ur5 = (replace(load_reachability(robot), facts={"source": source_digest("mico", 3)}) for robot in ROBOT_NAMES)
    assert is_up_to_date(mico, 3)
    assert not is_up_to_date(ur5, 3) and not is_up_to_date(mico, 4) and not is_up_to_date(mico, 3, SMALL)


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_signs_agree_with_ik(robot: str):
    Ts = poses(robot, 1, 3000)
    result = agreement(load_reachability(robot).signed_distance(Ts) > 0.0, Oracle(load_kinematics(robot)).reachable(Ts))
    assert 0.1 < result.reachable < 0.9
    assert result.accuracy >= 0.97 and result.false_positives <= 0.01


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_where_the_hand_is_at_home_is_well_inside(robot: str):
    kinematics = load_kinematics(robot)
    Ts = poses(robot, 2, 300)
    free = [q for T in Ts for q in Oracle(kinematics).free_postures(T)[:1]]
    distances = load_reachability(robot).signed_distance(kinematics.fk_many(np.array(free)))
    assert (distances > 0.0).mean() >= 0.95 and distances.max() > 0.05


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_far_away_and_below_the_floor_are_unreachable(robot: str):
    Ts = poses(robot, 3, 200)
    far, below = Ts.copy(), Ts.copy()
    far[:, :2, 3] *= (2.0 / np.linalg.norm(far[:, :2, 3], axis=1))[:, None]
    below[:, 2, 3] = -0.10
    reach = load_reachability(robot)
    assert reach.signed_distance(far).max() < -0.5
    assert reach.signed_distance(below).max() < -0.05


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_turning_about_the_base_changes_nothing(robot: str):
    Ts, reach = poses(robot, 4, 500), load_reachability(robot)
    turn = Pose.from_xyz_yaw((0.0, 0.0, 0.0), 2.1).matrix
    np.testing.assert_allclose(reach.signed_distance(turn @ Ts), reach.signed_distance(Ts), atol=1e-9)


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_a_small_step_changes_the_distance_little(robot: str):
    """Off the base's axis, where turning about it costs nothing that the chart doesn't see."""
    rng = np.random.default_rng(5)
    Ts = poses(robot, 5, 2000)
    Ts = Ts[np.hypot(Ts[:, 0, 3], Ts[:, 1, 3]) > 0.2]
    moved = Ts.copy()
    moved[:, :3, 3] += 0.001 * rng.standard_normal((len(Ts), 3))
    moved[:, :3, :3] = Pose.from_xyz_rpy((0.0, 0.0, 0.0), rng.normal(0.0, 0.007, 3)).rotation @ Ts[:, :3, :3]
    way = np.linalg.norm(moved[:, :3, 3] - Ts[:, :3, 3], axis=1)
    angle = np.array([rotation_angle_rad(a[:3, :3], b[:3, :3]) for a, b in zip(Ts, moved, strict=True)])
    reach = load_reachability(robot)
    change = np.abs(reach.signed_distance(moved) - reach.signed_distance(Ts))
    assert (change / np.hypot(way, METRES_PER_RADIAN * angle)).max() < 5.0
    assert np.median(change / np.hypot(way, METRES_PER_RADIAN * angle)) < 1.0


def test_roll_is_periodic():
    reach = load_reachability("mico")
    T = Pose.from_xyz_rpy((0.35, 0.1, 0.2), (np.pi, 0.0, 0.0)).matrix
    turned = [T @ Pose.from_xyz_yaw((0.0, 0.0, 0.0), yaw).matrix for yaw in (-np.pi, np.pi, np.pi - 1e-9)]
    values = reach.signed_distance(np.array(turned))
    np.testing.assert_allclose(values, values[0], atol=1e-6)


def test_a_pose_that_is_not_finite_is_infinitely_far_away():
    T = np.tile(np.eye(4), (2, 1, 1))
    T[0, 0, 3], T[1, 0, 0] = np.inf, np.nan
    assert (load_reachability("mico").signed_distance(T) == -np.inf).all()


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_a_shipped_field_says_how_it_was_made_and_how_good_it_is(robot: str):
    facts = load_reachability(robot).facts
    assert facts["seed"] == 0 and facts["metrics"]["robot"] == robot and "numba" in facts["versions"]
    assert reachability_file(robot).stat().st_size <= 2_000_000


def test_the_same_seed_builds_the_same_field_whatever_the_workers(tmp_path: Path):
    kinematics = load_kinematics("mico")
    one, two = (build_reachability(kinematics, 3, lambda _: None, workers, SMALL) for workers in (1, 2))
    assert one.levels.tobytes() == two.levels.tobytes()
    assert one.levels.min() < 0 < one.levels.max()
    again = read_reachability(save_reachability(one, tmp_path / "mico.npz"), "mico")
    assert again.levels.tobytes() == one.levels.tobytes() and again.facts["seed"] == 3
    assert list(tmp_path.iterdir()) == [tmp_path / "mico.npz"]


def test_calibration_leaves_no_more_false_positives_than_wanted():
    rng = np.random.default_rng(6)
    truth = rng.random(5000) < 0.5
    distances = np.where(truth, 0.05, -0.02) + rng.normal(0.0, 0.03, 5000)
    shift = calibrated_shift(distances, truth, 0.01)
    assert shift > 0.0 and agreement(distances > shift, truth).false_positive_rate <= 0.01
    assert calibrated_shift(np.where(truth, 1.0, -1.0), truth) == 0.0


def test_an_unknown_robot_lists_what_exists():
    with pytest.raises(NotFoundError, match="no robot named 'ur6'"):
        load_reachability("ur6")


def test_a_missing_field_says_how_to_make_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def elsewhere(robot: str) -> Path:
        return tmp_path / f"{robot}.npz"

    monkeypatch.setattr(knowledge, "reachability_file", elsewhere)
    load_reachability.cache_clear()
    with pytest.raises(MissingResourceError, match=r"mico\.npz is missing.*build reachability --robot mico"):
        load_reachability("mico")
    load_reachability.cache_clear()


def test_a_truncated_field_is_refused_by_name(tmp_path: Path):
    whole = reachability_file("mico").read_bytes()
    path = tmp_path / "mico.npz"
    for content in (b"", b"no field", whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(InvalidInputError, match=r"mico\.npz: not a reachability field of mico .*--robot mico"):
            read_reachability(path, "mico")


def test_a_foreign_field_is_refused():
    with pytest.raises(InvalidInputError, match=r"not a reachability field of mico \(it belongs to ur5_robotiq\)"):
        read_reachability(reachability_file("ur5_robotiq"), "mico")


def test_an_arm_that_does_not_turn_freely_is_refused():
    kinematics = load_kinematics("mico")
    limits = kinematics.limits.copy()
    limits[:, -1] = -1.0, 1.0
    with pytest.raises(InvalidInputError, match="turns freely about the hand's approach"):
        build_reachability(replace(kinematics, limits=limits), 0, lambda _: None, 1, SMALL)
