"""``object``: from a mesh file to a trial with it, as its owner would go; and nothing is left of what fails."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.backend_engine import BackendEngine
from backend.build.grasps import GraspSettings, build_grasps
from backend.cli import main
from backend.knowledge.grasps import grasp_file, save_grasps
from backend.objects import OBJECTS, load_object
from tests.objects import meshes

FEW = GraspSettings(candidates=24, rounds=((24, 1), (8, 2)))


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty data folder."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data"


@pytest.fixture
def block(tmp_path: Path) -> str:
    """A file in millimetres."""
    return str(meshes.written(meshes.box(40, 50, 100), tmp_path / "block.stl"))


def added(file: str, name: str, *more: str) -> int:
    return main(["object", "add", file, "--name", name, "--mass-kg", "0.2", "--scale", "0.001", *more])


def files(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


def test_a_mesh_becomes_an_object_that_is_grasped(data: Path, block: str, capsys: pytest.CaptureFixture[str]):
    assert added(block, "block", "--upright", "--title", "A block") == 0
    text = capsys.readouterr().out
    assert "block: 4.0 x 5.0 x 10.0 cm, 0.2 kg (1 g/cm^3)" in text
    assert "1 convex parts; their union is 0." in text and "fits the hands of: mico, ur5_robotiq" in text
    assert "python -m backend build grasps --object block" in text
    assert "python -m backend build motion-aware --object block" in text
    assert "python -m backend trial ur5_linear --set object=block" in text

    trial = ["trial", "ur5_linear", "--seed", "1", "--set", "object=block"]
    assert main(trial) == 2
    assert "python -m backend build grasps --robot ur5_robotiq --object block" in capsys.readouterr().err

    save_grasps(build_grasps("ur5_robotiq", "block", 3, 4, lambda _: None, FEW))
    assert grasp_file("ur5_robotiq", "block").is_relative_to(data)
    assert main(trial) == 2
    assert "python -m backend build motion-aware --robot ur5_robotiq --object block" in capsys.readouterr().err
    assert main([*trial, "--set", "method=reachability", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert row["object"] == "block" and row["strict"] is True

    assert main(["object", "list", "--json"]) == 0
    rows = {entry["name"]: entry for entry in json.loads(capsys.readouterr().out)["objects"]}
    assert list(rows) == [*OBJECTS, "block"]
    assert rows["block"]["grasps"] == ["ur5_robotiq"] and rows["block"]["built_in"] is False

    assert main(["object", "remove", "block"]) == 0
    assert [name for name in files(data) if name.endswith(".npz")] == []
    assert main(trial) == 2
    assert "no object named 'block'" in capsys.readouterr().err


def test_build_grasps_writes_beside_the_users_objects(
    data: Path, block: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    added(block, "block")
    capsys.readouterr()
    monkeypatch.setattr("backend.build.grasps.GraspSettings", lambda: FEW)
    assert main(["build", "grasps", "--robot", "mico", "--object", "block", "--count", "5", "--json"]) == 0
    (built,) = json.loads(capsys.readouterr().out)["databases"]
    assert built["grasps"] >= 1
    assert built["file"] == str(data / "dynamic-grasping" / "grasps" / "mico" / "block.npz")


def test_an_added_object_appears_where_objects_are_listed(data: Path, block: str, capsys: pytest.CaptureFixture[str]):
    assert BackendEngine().object_names() == tuple(OBJECTS)
    added(block, "block")
    assert BackendEngine().object_names() == (*OBJECTS, "block")
    capsys.readouterr()
    main(["info", "--json"])
    assert json.loads(capsys.readouterr().out)["objects"] == [*OBJECTS, "block"]


def test_json_is_one_object_on_stdout_with_what_was_found(data: Path, block: str):
    command = [sys.executable, "-m", "backend", "object", "add", block, "--name", "block", "--mass-kg", "0.2", "--json"]
    answer = subprocess.run([*command, "--scale", "0.001"], capture_output=True, text=True, check=True)
    entry = json.loads(answer.stdout)["object"]
    assert sorted(entry["size_m"]) == [0.04, 0.05, 0.1] and entry["parts"] == 1 and entry["steady"] is True
    assert abs(entry["volume_error"]) < 0.02 and 0.2 < entry["resting_probability"] < 0.4
    assert entry["hands"] == ["mico", "ur5_robotiq"] and Path(entry["file"]).is_file()


def test_what_its_owner_says_is_kept(data: Path, block: str):
    added(block, "block", "--title", "My block", "--color", "#0102ff", "--friction", "0.9")
    described = load_object("block")
    assert (described.title, described.color_rgb, described.lateral_friction) == ("My block", (1, 2, 255), 0.9)
    assert described.mass_kg == 0.2 and np.trace(described.inertia_kgm2) > 0


def test_a_taken_name_is_refused_unless_replaced(data: Path, block: str, capsys: pytest.CaptureFixture[str]):
    added(block, "block")
    before = files(data)
    capsys.readouterr()
    assert added(block, "block", "--title", "Another") == 2
    captured = capsys.readouterr()
    assert "There is an object named 'block' already" in captured.err and "--replace" in captured.err
    assert load_object("block").title == "Block"
    grasps = grasp_file("mico", "block")
    grasps.parent.mkdir(parents=True)
    grasps.write_bytes(b"of the old one")
    assert added(block, "block", "--title", "Another", "--replace") == 0
    assert load_object("block").title == "Another" and not grasps.exists()
    assert [name for name in files(data) if name.endswith(".npz")] == [n for n in before if n.endswith(".npz")]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--scale", "1"], "--scale 0.001 if it is in millimetres"),
        (["--scale", "nan"], "--scale must be between"),
        (["--name", "cube"], "cube is the name of an object that comes with the project"),
        (["--name", "My block"], "--name is of lower-case letters"),
        (["--mass-kg", "0"], "--mass-kg must be between"),
        (["--parts", "0"], "--parts must be between"),
        (["--color", "red"], "--color is six hexadecimal digits"),
        (["--scale", "0.004"], "No hand can hold block.stl"),
    ],
)
def test_what_fails_leaves_nothing(
    data: Path, block: str, capsys: pytest.CaptureFixture[str], more: list[str], words: str
):
    assert added(block, "block", *more) == 2
    captured = capsys.readouterr()
    assert words in captured.err and captured.out == ""
    assert files(data) == []


def test_a_failed_replacement_keeps_the_old_one(data: Path, block: str, tmp_path: Path):
    added(block, "block")
    grasps = grasp_file("mico", "block")
    grasps.parent.mkdir(parents=True)
    grasps.write_bytes(b"of the old one")
    before = {path: path.read_bytes() for path in data.rglob("*") if path.is_file()}
    (tmp_path / "broken.glb").write_bytes(b"glTF")
    assert added(str(tmp_path / "broken.glb"), "block", "--replace") == 2
    assert {path: path.read_bytes() for path in data.rglob("*") if path.is_file()} == before


def test_only_own_objects_are_removed(data: Path, block: str, capsys: pytest.CaptureFixture[str]):
    added(block, "block")
    capsys.readouterr()
    assert main(["object", "remove", "cube"]) == 2
    assert "cube comes with the project and stays" in capsys.readouterr().err
    assert main(["object", "remove", "blok"]) == 2
    assert "no object of your own named 'blok'. Available: block. Did you mean 'block'?" in capsys.readouterr().err


def test_a_damaged_object_hides_no_other(data: Path, capsys: pytest.CaptureFixture[str]):
    (data / "dynamic-grasping" / "objects").mkdir(parents=True)
    (data / "dynamic-grasping" / "objects" / "odd.npz").write_bytes(b"nonsense")
    assert main(["object", "list"]) == 0
    text = capsys.readouterr().out
    assert "cube: 5.0 x 5.0 x 5.0 cm" in text and "odd.npz: not an object that this version can read" in text
    assert main(["trial", "ur5_linear", "--set", "object=odd"]) == 2
    assert "Add it again" in capsys.readouterr().err


def test_surveys_are_of_the_seven(data: Path, block: str):
    from argparse import Namespace

    from backend.cli.survey import _jobs  # pyright: ignore[reportPrivateUsage]

    added(block, "block")
    jobs = _jobs(Namespace(scenarios=["ur5_linear"], objects=None, seeds=1, overrides=[]))
    assert [job.scenario.object for job in jobs] == list(OBJECTS)
    (job,) = _jobs(Namespace(scenarios=["ur5_linear"], objects=["block"], seeds=1, overrides=[]))
    assert job.scenario.object == "block"
