"""Meshes, files and wishes that no object can be made of: each is named, with what would work."""

from pathlib import Path
from typing import Any, cast

import pytest
import trimesh

from backend.build import mesh_file
from backend.build.own_object import make_own
from backend.errors import InvalidInputError
from tests.objects import meshes
from tests.objects.making import made_of, silent, wanted

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
        make_own(tmp_path / name, wanted(), silent)


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r"There is no mesh file .*nowhere\.stl"):
        make_own(tmp_path / "nowhere.stl", wanted(), silent)


def test_a_large_file_is_refused_before_it_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "large.stl"
    with path.open("wb") as file:
        file.truncate(201_000_000)
    monkeypatch.setattr(Path, "open", pytest.fail)
    with pytest.raises(InvalidInputError, match=r"large\.stl has 201 MB, more than 200"):
        make_own(path, wanted(), silent)


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
