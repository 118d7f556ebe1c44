"""Objects of users: what is made of a mesh, against Qhull, formulas and physics."""

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from backend.build.mesh_file import read_mesh
from backend.build.own_object import Made, make_own
from backend.build.resting import is_steady, rests
from backend.objects import Mesh, load_object
from backend.pose import Array, Pose, rotation_angle_rad
from backend.sim.bullet import STEP_S, Bullet
from tests.objects import meshes
from tests.objects.making import made_of, silent, wanted


@pytest.fixture(scope="module")
def mug(tmp_path_factory: pytest.TempPathFactory) -> Made:
    return made_of(meshes.mug(), tmp_path_factory.mktemp("mug"), scale=0.001)


@pytest.fixture(scope="module")
def torus(tmp_path_factory: pytest.TempPathFactory) -> Made:
    return made_of(meshes.torus(), tmp_path_factory.mktemp("torus"))


@pytest.fixture(params=["mug", "torus"])
def made(request: pytest.FixtureRequest) -> Made:
    return request.getfixturevalue(request.param)


def heights_above(part: Mesh, points: Array) -> Array:
    """(n,) how far points lie outside the plane of a convex mesh that is furthest below them, by Qhull."""
    planes = ConvexHull(part.vertices).equations
    return (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)


def test_parts_are_convex_closed_and_few(made: Made):
    parts = made.described.convex_parts
    assert 5 <= len(parts) <= 24
    for part in parts:
        oracle = part.as_trimesh()
        assert oracle.is_watertight and oracle.is_winding_consistent
        assert part.volume_m3 == pytest.approx(ConvexHull(part.vertices).volume)
        assert heights_above(part, part.vertices).max() < 1e-7


def test_the_union_of_the_parts_is_near_the_mesh_and_its_error_is_said(made: Made):
    described = made.described
    low, high = described.visual.bounds_m
    points = np.random.default_rng(8).uniform(low, high, (120_000, 3))
    inside = np.min([heights_above(part, points) for part in described.convex_parts], axis=0) < 0
    union_m3 = inside.mean() * np.prod(high - low)
    assert union_m3 / described.visual.volume_m3 - 1 == pytest.approx(made.volume_error, abs=0.025)
    assert abs(made.volume_error) < 0.15


def test_the_hollow_stays_hollow(mug: Made):
    axis = np.column_stack([np.zeros((20, 2)), np.linspace(0.03, 0.06, 20)])
    assert mug.described.height_m == pytest.approx(0.090), "it stands, or lies on its mouth"
    assert min(heights_above(part, axis).min() for part in mug.described.convex_parts) > 0.02


def test_volume_and_inertia_are_the_toruss(torus: Made):
    major, minor, mass = 0.030, 0.012, 0.2
    assert torus.described.visual.volume_m3 == pytest.approx(2 * np.pi**2 * major * minor**2, rel=0.02)
    about_axis = mass * (major**2 + 0.75 * minor**2)
    across = mass * (0.5 * major**2 + 0.625 * minor**2)
    assert np.allclose(torus.described.inertia_kgm2, np.diag([across, across, about_axis]), atol=0.02 * about_axis)


def test_the_frame_is_the_houses(made: Made):
    described = made.described
    corners = np.concatenate([part.vertices for part in described.convex_parts])
    assert abs(corners[:, 2].min()) < 1e-4 and abs(described.visual.bounds_m[0, 2]) < 1e-9
    assert np.allclose(described.visual.bounds_m[:, :2].sum(axis=0), 0, atol=1e-9)
    assert np.allclose(described.footprint_m.min(axis=0) + described.footprint_m.max(axis=0), 0, atol=5e-4)


@pytest.mark.parametrize("yaw_rad", [0.0, 2.0])
def test_it_stands_where_it_is_put(made: Made, yaw_rad: float):
    with Bullet() as bullet:
        bullet.add_floor()
        start = Pose.from_xyz_yaw((0.4, -0.2, 0.0), yaw_rad)
        body = bullet.add_object(made.described, start)
        bullet.step(round(2.0 / STEP_S))
        end = bullet.pose(body)
    assert np.linalg.norm(end.xyz_m - start.xyz_m) < 0.002
    assert np.degrees(rotation_angle_rad(start.rotation, end.rotation)) < 1.0
    assert made.steady


def test_the_same_file_makes_the_same_object(torus: Made, tmp_path: Path):
    again = made_of(meshes.torus(), tmp_path)
    for a, b in zip(again.described.convex_parts, torus.described.convex_parts, strict=True):
        assert np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces)
    assert again.volume_error == torus.volume_error


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "glb"])
def test_every_format_gives_the_same_box(ending: str, tmp_path: Path):
    described = made_of(meshes.box(0.04, 0.05, 0.10), tmp_path, ending).described
    assert np.allclose(sorted(np.ptp(described.visual.bounds_m, axis=0)), [0.04, 0.05, 0.10])
    assert described.height_m == pytest.approx(0.04)
    assert len(described.convex_parts) == 1 and described.convex_parts[0].volume_m3 == pytest.approx(2e-4, rel=1e-3)


def test_upright_keeps_the_files_up(tmp_path: Path):
    tall = meshes.box(0.04, 0.05, 0.10)
    assert np.allclose(np.ptp(made_of(tall, tmp_path, upright=True).described.visual.bounds_m, axis=0), tall.extents)
    glb = made_of(tall, tmp_path, "glb", upright=True).described
    assert glb.height_m == pytest.approx(0.05), "glTF is y up"


def test_probabilities_of_a_boxs_ways_to_lie_are_their_solid_angles_ways(tmp_path: Path):
    body = made_of(meshes.box(0.04, 0.05, 0.10), tmp_path).described.visual
    ways = rests(body, 0)
    assert len(ways) == 6
    assert sum(way.probability for way in ways) == pytest.approx(1.0)
    assert abs(ways[0].up[2]) == pytest.approx(1.0) and ways[0].probability == pytest.approx(ways[1].probability)
    for way in ways:
        assert np.allclose(way.rotation @ way.up, (0, 0, 1)) and np.linalg.det(way.rotation) == pytest.approx(1.0)


def test_a_ball_is_said_to_roll(tmp_path: Path):
    ball = made_of(meshes.ball(), tmp_path)
    assert not ball.steady
    assert is_steady(load_object("cube"))


def test_holes_are_closed_and_faces_turned_and_both_are_said(tmp_path: Path):
    lidless = made_of(meshes.lidless(meshes.box(0.04, 0.05, 0.06)), tmp_path)
    assert lidless.repairs == ("closed its holes (4 open edges)",)
    assert lidless.described.visual.volume_m3 == pytest.approx(1.2e-4)
    turned = made_of(meshes.inside_out(meshes.torus()), tmp_path)
    assert turned.repairs == ("turned its faces outwards",)
    assert turned.described.visual.volume_m3 > 0


def test_hands_are_told_apart_by_their_opening(tmp_path: Path, mug: Made):
    assert made_of(meshes.box(0.095, 0.095, 0.095), tmp_path).hands == ("mico",)
    assert set(mug.hands) <= {"mico", "ur5_robotiq"} and mug.hands


def test_a_scenes_transforms_count(tmp_path: Path):
    scene = cast(Any, trimesh).Scene()
    T = np.diag([1e-3, 1e-3, 1e-3, 1.0])
    T[:3, 3] = 0.1, 0.0, 0.2
    scene.add_geometry(meshes.box(40, 50, 100), transform=T)
    scene.export(str(tmp_path / "scene.glb"))
    assert np.allclose(read_mesh(tmp_path / "scene.glb", 1.0).extents, (0.04, 0.10, 0.05))


def test_seams_of_a_texture_tear_nothing(tmp_path: Path):
    corners = [f"v {x} {y} {z}" for x in (0, 0.05) for y in (0, 0.05) for z in (0, 0.05)]
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    faces = ["f " + " ".join(f"{v}/{i + 1}" for i, v in enumerate(quad)) for quad in quads]
    lines = ["mtllib nowhere.mtl", *corners, "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", *faces]
    (tmp_path / "textured.obj").write_text("\n".join(lines))
    made = make_own(tmp_path / "textured.obj", wanted(), silent)
    assert made.repairs == () and made.described.visual.volume_m3 == pytest.approx(1.25e-4)
