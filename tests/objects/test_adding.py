"""Objects of users: what is made of a mesh, against trimesh and physics, and what is refused and how."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from backend.build import mesh_file
from backend.build.own_object import Made, Wanted, make_own
from backend.build.resting import is_steady, rests
from backend.errors import GraspingError, InvalidInputError, NotFoundError
from backend.knowledge.grasps import GraspDatabase, grasp_file, load_grasps, remove_grasps, save_grasps
from backend.objects import OBJECTS, Mesh, load_object, object_names
from backend.objects.own import load_own, own_file, own_names, save_own
from backend.pose import Array, Pose, rotation_angle_rad
from backend.sim.bullet import STEP_S, Bullet
from tests.objects import meshes

NO_NEWS: Callable[[str], None] = lambda _: None  # noqa: E731


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty data folder."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data" / "dynamic-grasping"


def made_of(mesh: trimesh.Trimesh, folder: Path, ending: str = "stl", **wishes: Any) -> Made:
    path = meshes.written(mesh, folder / f"thing.{ending}")
    return make_own(path, wanted(**wishes), NO_NEWS)


def wanted(**wishes: Any) -> Wanted:
    defaults: dict[str, Any] = {"name": "thing", "mass_kg": 0.2}
    return Wanted(**(defaults | wishes))


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


REFUSED_MESHES: dict[str, tuple[trimesh.Trimesh, dict[str, Any], str]] = {
    "millimetres": (meshes.mug(), {}, r"thing.stl would be 90 m long .* --scale 0.001 if .*millimetres \(9 cm\)"),
    "divided twice": (meshes.box(4e-5, 5e-5, 1e-4), {}, r"0.1 mm long .* --scale 1000 if .* divided by 1000"),
    "no unit": (meshes.box(1e6, 1e6, 1e6), {}, r"What would work: a --scale between 1e-08 and 5e-07"),
    "two units": (meshes.box(6, 6, 10), {}, r"--scale 0.01 if .* centimetres \(10 cm\), or --scale 0.0254 if"),
    "two bodies": (
        meshes.apart(meshes.box(0.05, 0.05, 0.05), meshes.box(0.03, 0.03, 0.03)),
        {},
        r"holds 2 separate bodies \(longest sides: 5 cm, 3 cm\).*Boolean, Union",
    ),
    "torn": (meshes.torn(meshes.box(0.05, 0.05, 0.05)), {}, r"thing.stl is not closed: \d+ of .*Make Manifold"),
    "flat": (meshes.box(0.05, 0.05, 1e-9), {}, r"thing.stl encloses no volume: it is flat"),
    "too thick": (meshes.box(0.15, 0.15, 0.15), {}, r"No hand can hold thing.stl \(15 x 15 x 15 cm\).*opens 11 cm"),
    "too thin": (meshes.box(0.2, 0.15, 0.004), {}, r"No hand can hold thing.stl .*at least 1 cm apart"),
    "grams": (meshes.box(0.02, 0.02, 0.02), {"mass_kg": 4.0}, r"holds 8 cm\^3; with --mass-kg 4 .*denser than any"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED_MESHES)
def test_a_mesh_that_cannot_be_an_object_is_answered_with_what_would_work(case: str, tmp_path: Path):
    mesh, wishes, words = REFUSED_MESHES[case]
    with pytest.raises(InvalidInputError, match=words):
        made_of(mesh, tmp_path, **wishes)


def test_an_upright_that_tips_over_is_refused(tmp_path: Path):
    leaning = meshes.box(0.03, 0.03, 0.12)
    leaning.apply_transform(cast(Any, trimesh.transformations).rotation_matrix(0.7, (1, 0, 0)))
    with pytest.raises(InvalidInputError, match=r"tips over when it is put down upright; leave out --upright"):
        made_of(leaning, tmp_path, upright=True)


OBJ_NAN = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 nan\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
REFUSED_FILES: dict[str, tuple[str, bytes, str]] = {
    "empty": ("a.stl", b"", r"a\.stl is empty"),
    "no triangles": ("a.obj", b"v 0 0 0\nv 1 0 0\n", r"a\.obj"),
    "not finite": ("a.obj", OBJ_NAN.encode(), r"a\.obj: 1 of its 4 vertices are not finite"),
    "a cloud": (
        "a.ply",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        b"end_header\n0 0 0\n",
        r"a\.ply holds no triangles",
    ),
    "broken glb": ("a.glb", b"glTF but not really", r"a\.glb is not a \.glb mesh that can be read \("),
    "broken ply": ("a.ply", b"ply\nformat nonsense\n", r"a\.ply is not a \.ply mesh that can be read \("),
    "broken stl": ("a.stl", b"\x00" * 100, r"a\.stl"),
    "unsupported": ("a.step", b"ISO-10303-21;", r"\.step files are not read. Export it as one of: \.obj, \.stl"),
    "no ending": ("a", b"x", r"files without an ending are not read"),
}


@pytest.mark.parametrize("case", REFUSED_FILES)
def test_a_file_that_cannot_be_read_is_named(case: str, tmp_path: Path):
    name, content, words = REFUSED_FILES[case]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InvalidInputError, match=words):
        make_own(tmp_path / name, wanted(), NO_NEWS)


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r"There is no mesh file .*nowhere\.stl"):
        make_own(tmp_path / "nowhere.stl", wanted(), NO_NEWS)


def test_a_large_file_is_refused_before_it_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "large.stl"
    with path.open("wb") as file:
        file.truncate(201_000_000)
    monkeypatch.setattr(Path, "open", pytest.fail)
    with pytest.raises(InvalidInputError, match=r"large\.stl has 201 MB, more than 200"):
        make_own(path, wanted(), NO_NEWS)


def test_too_many_triangles_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(mesh_file, "MOST_TRIANGLES", 11)
    with pytest.raises(InvalidInputError, match=r"has 12 triangles, more than 11\. Simplify it first"):
        made_of(meshes.box(0.05, 0.05, 0.05), tmp_path)


@pytest.mark.parametrize(
    ("wishes", "words"),
    [
        ({"name": "Mug"}, "--name is of lower-case letters"),
        ({"name": "../mug"}, "--name is of lower-case letters"),
        ({"name": "cube"}, "cube is the name of an object that comes with the project"),
        ({"mass_kg": 300.0}, r"--mass-kg must be between 0.001 and 5 \(got 300\)"),
        ({"mass_kg": float("nan")}, r"--mass-kg must be between .*got nan"),
        ({"scale": 0.0}, "--scale must be between"),
        ({"friction": -1.0}, "--friction must be between"),
        ({"most_parts": 0}, "--parts must be between 1 and 64"),
        ({"concavity": 0.0}, "--concavity must be between"),
        ({"seed": -1}, "--seed must be between"),
        ({"color": "red"}, "--color is six hexadecimal digits"),
    ],
)
def test_wishes_that_cannot_be_are_refused(wishes: dict[str, Any], words: str):
    with pytest.raises(InvalidInputError, match=words):
        wanted(**wishes)


def test_a_kept_object_appears_and_is_what_was_made(own: Path, mug: Made):
    assert own_names() == () and object_names() == tuple(OBJECTS)
    described = dataclasses.replace(mug.described, name="mug", color_rgb=(1, 2, 3), lateral_friction=0.4)
    path = save_own(described)
    assert path == own / "objects" / "mug.npz" and [p.name for p in path.parent.iterdir()] == ["mug.npz"]
    assert object_names() == (*OBJECTS, "mug")
    read = load_object("mug")
    for field in ("name", "title", "mass_kg", "color_rgb", "lateral_friction", "spinning_friction", "source"):
        assert getattr(read, field) == getattr(described, field)
    for a, b in zip((read.visual, *read.convex_parts), (described.visual, *described.convex_parts), strict=True):
        assert np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces)
    with pytest.raises(NotFoundError, match=r"no object named 'mugg'. Available: .*mug.* mean 'mug'"):
        load_object("mugg")


def test_a_replaced_object_is_read_anew(own: Path, mug: Made):
    save_own(mug.described)
    assert load_own("thing").title == "Thing"
    save_own(dataclasses.replace(mug.described, title="Another"))
    assert load_own("thing").title == "Another"


@pytest.mark.parametrize("damage", [b"", b"not a zip", b"PK\x03\x04 cut short"])
def test_a_damaged_object_names_its_file_and_what_to_do(own: Path, damage: bytes):
    own_file("thing").parent.mkdir(parents=True)
    own_file("thing").write_bytes(damage)
    with pytest.raises(InvalidInputError, match=r"thing\.npz: not an object .*add FILE --name thing .*--replace"):
        load_object("thing")


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mug: Made):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "file"))
    with pytest.raises(InvalidInputError, match=r"Cannot write .*thing\.npz"):
        save_own(mug.described)


def test_grasps_of_an_own_object_lie_with_it_and_go_with_it(own: Path, mug: Made):
    save_own(mug.described)
    with pytest.raises(GraspingError, match="python -m backend build grasps --robot mico --object thing"):
        load_grasps("mico", "thing")
    save_grasps(GraspDatabase("mico", "thing", np.eye(4)[None], np.array([1]), np.array([1])))
    assert grasp_file("mico", "thing") == own / "grasps" / "mico" / "thing.npz"
    assert len(load_grasps("mico", "thing")) == 1
    assert own not in grasp_file("mico", "cube").parents
    remove_grasps("thing")
    assert not grasp_file("mico", "thing").exists()
