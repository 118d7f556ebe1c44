"""Shelf: the files of what the robot knows beforehand, each listed with its checksum in ``assets/manifest.json``."""

from __future__ import annotations

import fcntl
import hashlib
import io
import json
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from backend import __version__
from backend.errors import InvalidInputError, MissingResourceError
from backend.files import cache_folder, replacing

ASSETS = Path(__file__).parent.parent / "assets"
MANIFEST = ASSETS / "manifest.json"
Arrays = dict[str, NDArray[Any]]
Facts = dict[str, Any]
_BROKEN = (OSError, EOFError, KeyError, TypeError, ValueError, AttributeError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True)
class Label:
    """What a file is."""

    what: str
    """In words, with whose it is: ``reachability field of mico``."""
    format: int
    """Of its contents; another one is refused."""
    command: str
    """What makes it anew."""
    owner: dict[str, str] = field(default_factory=dict[str, str])
    """Facts that say whose it is; a file of another one is refused."""

    @property
    def remedy(self) -> str:
        return f"Make it with: {self.command}"

    def refusal(self, path: Path, why: object) -> InvalidInputError:
        """The error that says that the file is not this."""
        return InvalidInputError(f"{path}: not a {self.what} ({why}). {self.remedy}")


def read(path: Path, label: Label) -> tuple[Arrays, Facts]:
    """The arrays of a file and the facts about them.

    Raises ``MissingResourceError`` when there is no such file, and ``InvalidInputError`` when it is not what the
    label says, or lies among the project's assets and is not what their manifest lists.
    """
    if not path.is_file():
        raise MissingResourceError(f"There is no {label.what}: {path} is missing. {label.remedy}")
    try:
        content = path.read_bytes()
        _check_listed(path, content)
        with np.load(io.BytesIO(content), allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
        facts = cast(Facts, json.loads(str(arrays.pop("facts"))))
        if facts.get("format") != label.format:
            raise ValueError(f"format {facts.get('format')}, this version reads {label.format}")
        if any(facts[fact] != value for fact, value in label.owner.items()):
            raise ValueError(f"it belongs to {' and '.join(str(facts[fact]) for fact in label.owner)}")
    except _BROKEN as error:
        raise label.refusal(path, error) from error
    for array in arrays.values():
        array.flags.writeable = False
    return arrays, facts


def write(path: Path, label: Label, arrays: Arrays, facts: Facts) -> Path:
    """Write a file in one step; one among the project's assets is listed in their manifest too."""
    facts = {**facts, **label.owner, "format": label.format}
    content = io.BytesIO()
    np.savez_compressed(content, allow_pickle=False, facts=np.array(json.dumps(facts, sort_keys=True)), **arrays)
    with replacing(path) as file:
        file.write(content.getvalue())
    if path.is_relative_to(ASSETS):
        _list(path, label, content.getvalue(), facts)
    return path


def manifest() -> dict[str, Facts]:
    """What is listed: path below the assets -> what it is, how it was made and measured, size and checksum."""
    if not MANIFEST.is_file():
        return {}
    listed: dict[str, Facts] = json.loads(MANIFEST.read_text())
    return listed


def _check_listed(path: Path, content: bytes) -> None:
    if not path.is_relative_to(ASSETS):
        return
    entry = manifest().get(path.relative_to(ASSETS).as_posix())
    if entry is None:
        raise ValueError(f"{MANIFEST.name} does not list it")
    if entry["sha256"] != hashlib.sha256(content).hexdigest():
        raise ValueError(f"its checksum is not the one in {MANIFEST.name}: truncated, or of another origin")


def _list(path: Path, label: Label, content: bytes, facts: Facts) -> None:
    """Enter a file, or enter it anew; several processes may."""
    cache_folder().mkdir(parents=True, exist_ok=True)
    with open(cache_folder() / ".manifest.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        listed = manifest()
        listed[path.relative_to(ASSETS).as_posix()] = {
            "what": label.what,
            "made_by": label.command,
            "project": __version__,
            "bytes": len(content),
            "sha256": hashlib.sha256(content).hexdigest(),
            "facts": facts,
        }
        with replacing(MANIFEST) as file:
            file.write((json.dumps(dict(sorted(listed.items())), indent=1, sort_keys=True) + "\n").encode())
