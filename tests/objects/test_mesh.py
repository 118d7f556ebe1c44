"""The light mesh against trimesh, the outline against Qhull, and the store of finished objects."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from backend.objects import OBJECTS, load_object
from backend.objects.outline import convex_outline
from backend.objects.store import stored


@pytest.mark.parametrize("name", OBJECTS)
def test_every_number_is_trimeshs(name: str):
    described = load_object(name)
    for mesh in (described.visual, *described.convex_parts):
        oracle = mesh.as_trimesh()
        assert np.allclose(mesh.face_normals, oracle.face_normals, atol=1e-9)
        assert np.allclose(mesh.face_areas_m2, oracle.area_faces, rtol=1e-9)
        assert np.allclose(mesh.bounds_m, oracle.bounds)
        assert mesh.volume_m3 == pytest.approx(oracle.volume)
        assert np.allclose(mesh.center_of_mass_m, oracle.center_mass, atol=1e-9)
        assert np.allclose(mesh.inertia_m5, oracle.moment_inertia, rtol=1e-6, atol=1e-12)


@given(st.integers(0, 2**32 - 1), st.integers(3, 80))
def test_the_outline_is_qhulls(seed: int, count: int):
    points = np.random.default_rng(seed).normal(size=(count, 2))
    corners = points[ConvexHull(points).vertices]
    first = np.lexsort((corners[:, 1], corners[:, 0]))[0]
    assert np.array_equal(convex_outline(points), np.roll(corners, -first, axis=0))


def test_an_outline_keeps_no_point_in_line_and_none_twice():
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0)), axis=-1).reshape(-1, 2)
    assert convex_outline(np.concatenate([grid, grid])).tolist() == [[0, 0], [3, 0], [3, 2], [0, 2]]


@pytest.fixture
def emptied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "dynamic-grasping" / "objects"


def test_a_stored_object_is_the_made_one(emptied: Path):
    made = stored("power_drill", OBJECTS["power_drill"])
    read = stored("power_drill", pytest.fail)
    assert len(list(emptied.iterdir())) == 1
    for field in ("name", "title", "mass_kg", "color_rgb", "lateral_friction", "spinning_friction", "source"):
        assert getattr(read, field) == getattr(made, field)
    for a, b in zip((read.visual, *read.convex_parts), (made.visual, *made.convex_parts), strict=True):
        assert np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces)


@pytest.mark.parametrize("damage", [b"", b"not a zip", b"PK\x03\x04 cut short"])
def test_a_damaged_file_is_made_anew(emptied: Path, damage: bytes):
    stored("cube", OBJECTS["cube"])
    (path,) = emptied.iterdir()
    whole = path.stat().st_size
    path.write_bytes(damage)
    assert stored("cube", OBJECTS["cube"]).title == "Cube (5 cm)"
    assert path.stat().st_size == whole
