"""The shelf of what is known: every file listed, and nothing else let in."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from backend.errors import InvalidInputError, MissingResourceError
from backend.knowledge import shelf
from backend.knowledge.shelf import ASSETS, Label, manifest, read, write

LABEL = Label("list of things", 2, "python -m backend build things")
ARRAYS = {"things": np.arange(5)}


@pytest.fixture
def assets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(shelf, "ASSETS", tmp_path / "assets")
    monkeypatch.setattr(shelf, "MANIFEST", tmp_path / "assets" / "manifest.json")
    return tmp_path / "assets"


def test_every_file_that_comes_with_the_project_is_listed_with_its_checksum_and_making():
    listed = manifest()
    files = {path.relative_to(ASSETS).as_posix(): path for path in ASSETS.rglob("*.npz")}
    assert set(listed) == set(files)
    for name, entry in listed.items():
        content = files[name].read_bytes()
        assert (entry["bytes"], entry["sha256"]) == (len(content), hashlib.sha256(content).hexdigest())
        assert entry["made_by"].startswith("python -m backend build ")
        assert "seed" in entry["facts"] and "settings" in entry["facts"]
    assert sum(entry["bytes"] for entry in listed.values()) <= 40e6


def test_what_is_written_is_listed_and_read_again(assets: Path):
    path = write(assets / "deep" / "things.npz", LABEL, ARRAYS, {"seed": 3})
    arrays, facts = read(path, LABEL)
    assert np.array_equal(arrays["things"], ARRAYS["things"]) and facts == {"seed": 3, "format": 2}
    assert not arrays["things"].flags.writeable
    entry = manifest()["deep/things.npz"]
    assert (entry["what"], entry["made_by"], entry["facts"]["seed"]) == (LABEL.what, LABEL.command, 3)
    write(assets / "other.npz", LABEL, ARRAYS, {})
    assert list(manifest()) == ["deep/things.npz", "other.npz"]
    assert sorted(p.name for p in assets.rglob("*") if p.is_file()) == ["manifest.json", "other.npz", "things.npz"]


@pytest.mark.parametrize("damage", ["cut", "empty", "text", "foreign"])
def test_a_file_that_is_not_the_listed_one_is_refused_by_name(assets: Path, damage: str):
    path = write(assets / "things.npz", LABEL, ARRAYS, {})
    foreign = write(assets / "foreign.npz", LABEL, {"things": np.zeros(5)}, {}).read_bytes()
    content = {"cut": path.read_bytes()[:200], "empty": b"", "text": b"things", "foreign": foreign}[damage]
    path.write_bytes(content)
    with pytest.raises(InvalidInputError, match=r"things\.npz: not a list of things .*checksum.*build things"):
        read(path, LABEL)


def test_a_file_that_nobody_listed_is_refused(assets: Path, tmp_path: Path):
    elsewhere = write(tmp_path / "things.npz", LABEL, ARRAYS, {})
    assert read(elsewhere, LABEL)[1] == {"format": 2}
    assets.mkdir()
    elsewhere.rename(assets / "things.npz")
    with pytest.raises(InvalidInputError, match=r"manifest\.json does not list it"):
        read(assets / "things.npz", LABEL)


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04 cut short"])
def test_a_broken_file_outside_the_project_is_refused_too(tmp_path: Path, content: bytes):
    (tmp_path / "things.npz").write_bytes(content)
    with pytest.raises(InvalidInputError, match=r"things\.npz: not a list of things .*build things"):
        read(tmp_path / "things.npz", LABEL)


def test_another_format_is_refused(tmp_path: Path):
    path = write(tmp_path / "things.npz", Label("list of things", 1, ""), ARRAYS, {})
    with pytest.raises(InvalidInputError, match="format 1, this version reads 2"):
        read(path, LABEL)
    np.savez(path, facts=np.array(json.dumps([])))
    with pytest.raises(InvalidInputError, match=r"not a list of things"):
        read(path, LABEL)


def test_a_missing_file_names_its_command(tmp_path: Path):
    with pytest.raises(MissingResourceError, match=r"no list of things.*gone\.npz is missing.*build things"):
        read(tmp_path / "gone.npz", LABEL)


def test_an_interrupted_write_leaves_the_old_file(assets: Path, monkeypatch: pytest.MonkeyPatch):
    path = write(assets / "things.npz", LABEL, ARRAYS, {})
    before = path.read_bytes()

    def fail(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez_compressed", fail)
    with pytest.raises(KeyboardInterrupt):
        write(path, LABEL, {"things": np.zeros(5)}, {})
    assert path.read_bytes() == before and len(list(assets.iterdir())) == 2
