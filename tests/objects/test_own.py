"""The folder of users' own objects: what is kept there is found, read anew, and goes with its grasps."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from backend.errors import GraspingError, InvalidInputError, NotFoundError
from backend.knowledge.grasps import GraspDatabase, grasp_file, load_grasps, save_grasps
from backend.knowledge.pairs import forget
from backend.objects import OBJECTS, ObjectDescription, load_object, object_names
from backend.objects.own import load_own, own_file, own_names, save_own


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty data folder."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data" / "dynamic-grasping"


@pytest.fixture
def thing() -> ObjectDescription:
    """One of several parts."""
    return dataclasses.replace(load_object("power_drill"), name="thing", title="Thing")


def test_a_kept_object_appears_and_is_what_was_made(own: Path, thing: ObjectDescription):
    assert own_names() == () and object_names() == tuple(OBJECTS)
    described = dataclasses.replace(thing, name="mug", color_rgb=(1, 2, 3), lateral_friction=0.4)
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


def test_a_replaced_object_is_read_anew(own: Path, thing: ObjectDescription):
    save_own(thing)
    assert load_own("thing").title == "Thing"
    save_own(dataclasses.replace(thing, title="Another"))
    assert load_own("thing").title == "Another"


@pytest.mark.parametrize("damage", [b"", b"not a zip", b"PK\x03\x04 cut short"])
def test_a_damaged_object_names_its_file_and_what_to_do(own: Path, damage: bytes):
    own_file("thing").parent.mkdir(parents=True)
    own_file("thing").write_bytes(damage)
    with pytest.raises(InvalidInputError, match=r"thing\.npz: not an object .*add FILE --name thing .*--replace"):
        load_object("thing")


def test_a_folder_that_cannot_be_written_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, thing: ObjectDescription
):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "file"))
    with pytest.raises(InvalidInputError, match=r"Cannot write .*thing\.npz"):
        save_own(thing)


def test_grasps_of_an_own_object_lie_with_it_and_go_with_it(own: Path, thing: ObjectDescription):
    save_own(thing)
    with pytest.raises(GraspingError, match="python -m backend build grasps --robot mico --object thing"):
        load_grasps("mico", "thing")
    save_grasps(GraspDatabase("mico", "thing", np.eye(4)[None], np.array([1]), np.array([1])))
    assert grasp_file("mico", "thing") == own / "grasps" / "mico" / "thing.npz"
    assert len(load_grasps("mico", "thing")) == 1
    assert own not in grasp_file("mico", "cube").parents
    forget("thing")
    assert not grasp_file("mico", "thing").exists()
