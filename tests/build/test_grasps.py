"""Grasps: candidates from geometry, lifts in simulation, and the database that comes with the project."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from backend.build.antipodal import BANDS, AntipodalSampler, Band
from backend.build.grasps import GraspSettings, build_grasps
from backend.build.lift import Bench, LiftSettings
from backend.errors import InvalidInputError, MissingResourceError, NotFoundError
from backend.knowledge import grasps as knowledge
from backend.knowledge.grasps import GraspDatabase, load_grasps, read_grasps, save_grasps
from backend.objects import OBJECTS, load_object
from backend.pose import Pose
from backend.robots import ROBOTS
from backend.robots.models import load_model

PAIRS = [(robot, name) for robot in sorted(ROBOTS) for name in sorted(OBJECTS)]
SMALL = GraspSettings(clean_lifts=4, clean_wanted=3, rounds=((3, 1),))


@pytest.mark.parametrize(("robot", "name"), PAIRS)
def test_every_pair_has_grasps_that_held(robot: str, name: str):
    database = load_grasps(robot, name)
    assert (database.robot, database.object) == (robot, name)
    assert len(database) >= 30
    assert (database.successes <= database.lifts).all() and database.lifts.min() >= 2
    assert np.median(database.quality) >= 0.8
    rotations = database.Ts_object_grasp[:, :3, :3]
    assert np.allclose(rotations @ rotations.transpose(0, 2, 1), np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(rotations), 1.0)


@pytest.mark.parametrize(("robot", "name"), PAIRS)
def test_grasps_come_from_several_directions_and_never_from_below(robot: str, name: str):
    approaches = load_grasps(robot, name).Ts_object_grasp[:, :3, 2]
    assert approaches[:, 2].max() < 0.1
    assert sum(any(band.holds(a) for a in approaches) for band in BANDS) >= 2


@pytest.mark.parametrize(("robot", "name"), [("mico", "bleach_cleanser"), ("ur5_robotiq", "power_drill")])
def test_the_best_grasps_lift_again(robot: str, name: str):
    database = load_grasps(robot, name)
    bench = Bench(load_model(robot), load_object(name), LiftSettings())
    assert all(bench.lift(Pose(T), None).held for T in database.Ts_object_grasp[:3])


def test_grasping_air_fails():
    bench = Bench(load_model("mico"), load_object("cube"), LiftSettings())
    beside = Pose.from_xyz_rpy((0.3, 0.0, 0.1), (np.pi, 0.0, 0.0))
    assert not bench.lift(beside, None).held


def test_a_hand_in_the_object_or_in_the_tray_is_not_clear():
    bench = Bench(load_model("ur5_robotiq"), load_object("cube"), LiftSettings())
    down = Pose.from_xyz_rpy((0.0, 0.0, 0.03), (np.pi, 0.0, 0.0))
    askew = Pose.from_xyz_rpy((0.0, 0.045, 0.03), (np.pi, 0.0, 0.0))
    deep = Pose.from_xyz_rpy((0.0, 0.0, -0.01), (np.pi, 0.0, 0.0))
    assert bench.is_clear(np.array([down.matrix, askew.matrix, deep.matrix])) == [True, False, False]


@pytest.mark.parametrize("band", BANDS, ids=lambda band: band.name)
def test_candidates_close_on_facing_surfaces_from_the_band_asked_for(band: Band):
    target = load_object("mustard_bottle")
    sampler = AntipodalSampler(load_model("mico").description, target, np.random.default_rng(1))
    drawn = [T for T in (sampler.draw(band) for _ in range(200)) if T is not None]
    assert len(drawn) > 20
    for T in drawn:
        assert band.holds(T[:3, 2])
        assert abs(T[:3, 1] @ T[:3, 2]) < 1e-9
        assert np.allclose(T[:3, :3].T @ T[:3, :3], np.eye(3), atol=1e-9)


def test_the_same_seed_builds_the_same_database():
    first, second = (build_grasps("mico", "cube", 5, 10, lambda _: None, SMALL) for _ in range(2))
    assert len(first) >= 1
    assert first.Ts_object_grasp.tobytes() == second.Ts_object_grasp.tobytes()
    assert (first.successes == second.successes).all()
    assert first.facts["seed"] == 5


def test_an_object_that_cannot_be_held_is_said():
    nothing_lifts = dataclasses.replace(SMALL, lift=LiftSettings(close_s=0.01))
    with pytest.raises(InvalidInputError, match="mico cannot hold cube: none of 4 grasps lifted it"):
        build_grasps("mico", "cube", 5, 10, lambda _: None, nothing_lifts)


def test_a_database_survives_the_file(tmp_path: Path):
    database = load_grasps("mico", "cube")
    path = save_grasps(database, tmp_path / "deep" / "cube.npz")
    again = read_grasps(path)
    assert again.Ts_object_grasp.tobytes() == database.Ts_object_grasp.tobytes()
    assert (again.lifts == database.lifts).all() and (again.successes == database.successes).all()
    assert [p.name for p in path.parent.iterdir()] == ["cube.npz"]


def test_a_database_that_is_not_built_names_its_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    def elsewhere(robot: str, object: str) -> Path:
        return tmp_path / robot / f"{object}.npz"

    monkeypatch.setattr(knowledge, "grasp_file", elsewhere)
    with pytest.raises(MissingResourceError, match="python -m backend build grasps --robot mico --object cube"):
        load_grasps("mico", "cube")


def test_unknown_names_are_refused():
    with pytest.raises(NotFoundError, match=r"no object named 'cub'.*cube"):
        load_grasps("mico", "cub")
    with pytest.raises(NotFoundError, match=r"no robot named 'ur5'.*ur5_robotiq"):
        load_grasps("ur5", "cube")


def test_a_file_that_is_no_database_is_named(tmp_path: Path):
    path = tmp_path / "cube.npz"
    path.write_text("nonsense")
    with pytest.raises(InvalidInputError, match=r"cube\.npz: not a grasp database"):
        read_grasps(path)
    newer = dataclasses.replace(load_grasps("mico", "cube"))
    save_grasps(newer, path)
    with np.load(path) as data:
        arrays = {name: data[name] for name in data.files}
    arrays["facts"] = np.array('{"format": 99}')
    np.savez(path, **arrays)
    with pytest.raises(InvalidInputError, match="format 99"):
        read_grasps(path)


def test_quality_is_the_share_of_lifts_that_held():
    database = GraspDatabase("mico", "cube", np.eye(4)[None].repeat(2, axis=0), np.array([4, 10]), np.array([3, 10]))
    assert database.quality.tolist() == [0.75, 1.0]
