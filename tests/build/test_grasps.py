"""Grasps: candidates from geometry, lifts in simulation, and the database that comes with the project."""

import dataclasses
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from backend.build import grasps as builder
from backend.build import racing
from backend.build.annealing import MOST_UPWARD, Annealer
from backend.build.grasp_figure import draw_grasps, hand_strokes
from backend.build.grasps import APART_M, APART_RAD, BRISK, GraspSettings, best, build_grasps, distinct, is_up_to_date
from backend.build.object_field import ObjectField, distance_at
from backend.build.racing import Noise, Racers, race
from backend.build.rig import Rig
from backend.build.sectors import SECTORS, count_by_sector, sectors
from backend.errors import InvalidInputError, MissingResourceError, NotFoundError
from backend.knowledge import grasps as knowledge
from backend.knowledge.grasps import GraspDatabase, load_grasps, read_grasps, save_grasps
from backend.objects import OBJECTS, Mesh, load_object
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.robots.models import load_model

PAIRS = [(robot, name) for robot in sorted(ROBOTS) for name in sorted(OBJECTS)]
SMALL = GraspSettings(candidates=24, rounds=((24, 1), (8, 3)))


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
    kept = count_by_sector(load_grasps(robot, name).Ts_object_grasp)
    assert sum(count > 0 for count in kept.values()) >= 3


@pytest.mark.parametrize(("robot", "name"), [("mico", "bleach_cleanser"), ("ur5_robotiq", "power_drill")])
def test_the_best_grasps_lift_again(robot: str, name: str):
    with Rig(load_model(robot), load_object(name)) as rig:
        assert all(rig.attempt(Pose(T)).held for T in load_grasps(robot, name).Ts_object_grasp[:3])


@pytest.fixture
def no_checkpoints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    def here(heat: object, settings: object) -> Path:
        return tmp_path / f"{hash((heat, settings))}.npz"

    monkeypatch.setattr(builder, "checkpoint_file", here)
    return tmp_path


@pytest.mark.usefixtures("no_checkpoints")
def test_the_same_seed_builds_the_same_database_with_any_number_of_workers():
    first, second = (build_grasps("mico", "cube", 5, 6, lambda _: None, SMALL, workers) for workers in (1, 2))
    assert len(first) == 6
    assert first.Ts_object_grasp.tobytes() == second.Ts_object_grasp.tobytes()
    assert (first.successes == second.successes).all() and (first.lifts == 3).all()
    assert first.facts["seed"] == 5
    assert first.facts["candidates"] == SMALL.candidates
    assert sum(first.facts["sectors_kept"].values()) == 6
    assert is_up_to_date(first, 5, 6, SMALL)
    assert not is_up_to_date(first, 5, 7, SMALL) and not is_up_to_date(first, 6, 6, SMALL)
    assert not is_up_to_date(first, 5, 6, dataclasses.replace(SMALL, rig=dataclasses.replace(BRISK, lift_s=0.5)))


def test_a_build_that_was_killed_anywhere_goes_on_to_the_same_end(
    no_checkpoints: Path, monkeypatch: pytest.MonkeyPatch
):
    hard = Noise(xy_m=0.03)
    settings = GraspSettings(candidates=36, rounds=((36, 1), (12, 4), (6, 8)), noise=hard)
    whole = build_grasps("mico", "cube", 7, 6, lambda _: None, settings)
    assert not list(no_checkpoints.iterdir())
    monkeypatch.setattr(builder, "SAVE_EVERY_S", 0.0)
    monkeypatch.setattr(racing, "RACERS_PER_TASK", 2)
    kills: list[int] = []
    told: list[str] = []
    monkeypatch.setattr(builder, "race", _killed_after(1, kills))
    resumed = None
    while resumed is None:
        try:
            resumed = build_grasps("mico", "cube", 7, 6, told.append, settings)
        except KeyboardInterrupt:
            assert len(list(no_checkpoints.iterdir())) == 1
    assert len(kills) >= 12, "several times amid every round"
    assert sum(text.startswith("annealing done") for text in told) == 1
    assert resumed.Ts_object_grasp.tobytes() == whole.Ts_object_grasp.tobytes()
    assert (resumed.successes == whole.successes).all()
    assert resumed.facts["lifts"] == whole.facts["lifts"]


def _killed_after(steps: int, kills: list[int]) -> Callable[..., Iterator[None]]:
    """A race that is killed once it has been saved ``steps`` times and would go on."""

    def killed(*arguments: Any) -> Iterator[None]:
        for step, _ in enumerate(race(*arguments)):
            if step == steps:
                kills.append(step)
                raise KeyboardInterrupt
            yield

    return killed


@pytest.mark.usefixtures("no_checkpoints")
def test_an_object_that_cannot_be_held_is_said():
    unmoved = dataclasses.replace(SMALL, rig=dataclasses.replace(BRISK, short_m=-1.0))
    with pytest.raises(InvalidInputError, match="mico cannot hold cube: none of 24 grasps lifted it"):
        build_grasps("mico", "cube", 5, 10, lambda _: None, unmoved)


@pytest.fixture(scope="module", params=[("mico", "mustard_bottle"), ("ur5_robotiq", "power_drill")], ids=str)
def annealed(request: pytest.FixtureRequest) -> tuple[str, str, Array]:
    robot, name = request.param
    batch = next(Annealer(load_model(robot), load_object(name), 3).batches())
    return robot, name, batch.Ts_object_grasp


def test_annealed_hands_are_poses_that_come_from_all_around_but_not_from_below(annealed: tuple[str, str, Array]):
    _, _, Ts = annealed
    assert len(Ts) > 60
    rotations = Ts[:, :3, :3]
    assert np.allclose(rotations.transpose(0, 2, 1) @ rotations, np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(rotations), 1.0)
    assert Ts[:, 2, 2].max() <= MOST_UPWARD
    assert sum(count > 0 for count in count_by_sector(Ts).values()) >= 4


def test_annealed_hands_are_clear_in_the_physics(annealed: tuple[str, str, Array]):
    robot, name, Ts = annealed
    with Rig(load_model(robot), load_object(name)) as rig:
        assert np.mean([rig.is_clear(Pose(T)) for T in Ts[:40]]) >= 0.8


def test_annealed_pads_are_on_both_sides_of_the_object(annealed: tuple[str, str, Array]):
    """By lines along the closing direction: they must cross the object, nearly at right angles to its surface."""
    _, name, Ts = annealed
    mesh = load_object(name).visual
    facing: list[float] = []
    for T in Ts[:60]:
        hit = first_face_on(mesh, T[:3, 3] - 0.2 * T[:3, 1], T[:3, 1])
        if hit is not None:
            facing.append(abs(float(mesh.face_normals[hit] @ T[:3, 1])))
    assert len(facing) >= 0.9 * 60
    assert np.median(facing) > np.cos(np.radians(25.0))


def first_face_on(mesh: Mesh, start: Array, along: Array) -> int | None:
    """The face that a line meets first (Moeller and Trumbore, 1997)."""
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    p = np.cross(along, c - a)
    determinant = np.einsum("ij,ij->i", b - a, p)
    from_a = start - a
    u = np.einsum("ij,ij->i", from_a, p) / determinant
    q = np.cross(from_a, b - a)
    v = q @ along / determinant
    way = np.where((u >= 0) & (v >= 0) & (u + v <= 1), np.einsum("ij,ij->i", q, c - a) / determinant, np.inf)
    return int(np.argmin(way)) if np.isfinite(way.min()) else None


@pytest.mark.parametrize("name", ["mustard_bottle", "power_drill"])
def test_the_objects_field_is_its_signed_distance(name: str):
    target = load_object(name)
    field = ObjectField.of(target)
    rng = np.random.default_rng(0)
    bounds = np.concatenate([part.bounds_m for part in target.convex_parts])
    points = rng.uniform(bounds.min(axis=0) - 0.03, bounds.max(axis=0) + 0.03, (300, 3))
    found = np.array([distance_at(field.arrays, *p) for p in points.tolist()])
    triangles = np.concatenate([part.triangles for part in target.convex_parts])
    outside = np.flatnonzero(found > 0.004)[:80]
    repeated = np.repeat(points[outside], len(triangles), axis=0)
    closest = cast(Any, trimesh.triangles).closest_point(np.tile(triangles, (len(outside), 1, 1)), repeated)
    oracle = np.linalg.norm(closest - repeated, axis=1).reshape(len(outside), -1).min(axis=1)
    assert np.abs(found[outside] - oracle).max() < 0.003
    inside = np.any([Delaunay(part.vertices).find_simplex(points) >= 0 for part in target.convex_parts], axis=0)
    sure = np.abs(found) > 0.003
    assert 10 < inside[sure].sum()
    assert ((found < 0)[sure] == inside[sure]).all()


def test_distinct_keeps_apart_what_differs_by_more_than_a_little():
    T = np.eye(4)
    shifted, turned = T.copy(), T.copy()
    shifted[0, 3] = 0.9 * APART_M
    turned[:3, :3] = Pose.from_xyz_yaw((0.0, 0.0, 0.0), 1.1 * APART_RAD).rotation
    none = np.zeros((0, 4, 4))
    assert len(distinct(np.array([T, shifted, turned]), none)) == 2
    assert len(distinct(np.array([turned]), np.array([T, turned]))) == 0


def test_the_best_are_those_that_held_oftenest_with_every_sector_that_is_not_far_behind():
    def facing(x: float, y: float, z: float) -> Array:
        T = np.eye(4)
        T[:3, 2] = (x, y, z)
        return T

    down, from_left = facing(0.0, 0.0, -1.0), facing(0.0, -1.0, 0.0)
    racers = Racers.of(np.array([down] * 30 + [from_left] * 10))
    racers.lifts[:] = 50
    racers.successes[:30], racers.successes[30:] = 50, 46
    kept = best(racers, 24)
    assert sectors(racers.Ts_object_grasp[kept]).tolist().count(2) == 2
    assert (np.diff(racers.successes[kept]) <= 0).all()
    racers.successes[30:] = 20
    assert set(best(racers, 24).tolist()) <= set(range(30))


@given(st.floats(-np.pi, np.pi), st.floats(0.0, np.pi / 2))
def test_every_approach_has_its_sector(azimuth: float, above: float):
    T = np.eye(4)
    came_from = np.array([np.cos(azimuth) * np.cos(above), np.sin(azimuth) * np.cos(above), np.sin(above)])
    T[:3, 2] = -came_from
    name = SECTORS[sectors(T[None])[0]]
    if np.degrees(above) > 50.5:
        assert name == "top"
    elif np.degrees(above) < 49.5:
        axis = {"+x": (1, 0), "-x": (-1, 0), "+y": (0, 1), "-y": (0, -1)}[name]
        assert came_from[:2] @ axis >= np.linalg.norm(came_from[:2]) * np.cos(np.radians(45.01))


def test_a_database_survives_the_file(tmp_path: Path):
    database = load_grasps("mico", "cube")
    path = save_grasps(database, tmp_path / "deep" / "cube.npz")
    again = read_grasps(path, "mico", "cube")
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
        read_grasps(path, "mico", "cube")
    save_grasps(load_grasps("mico", "sugar_box"), path)
    with pytest.raises(InvalidInputError, match="it belongs to mico and sugar_box"):
        read_grasps(path, "mico", "cube")


def test_quality_is_the_share_of_lifts_that_held():
    database = GraspDatabase("mico", "cube", np.eye(4)[None].repeat(2, axis=0), np.array([4, 10]), np.array([3, 10]))
    assert database.quality.tolist() == [0.75, 1.0]


def test_a_picture_is_drawn_of_every_hand(tmp_path: Path):
    path = draw_grasps([load_grasps("mico", "cube"), load_grasps("mico", "power_drill")], tmp_path)
    assert path.name == "grasps_mico.png" and path.stat().st_size > 10_000


def test_a_drawn_hand_lies_where_the_grasp_is():
    T = Pose.from_xyz_rpy((0.1, 0.2, 0.3), (np.pi, 0.0, 0.0)).matrix
    fingers, tips = hand_strokes(T)[:2], hand_strokes(T)[:2, 0]
    assert np.allclose(tips.mean(axis=0), T[:3, 3])
    assert np.allclose(fingers[:, 1] - fingers[:, 0], [[0.0, 0.0, 0.025]] * 2)
