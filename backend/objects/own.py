"""Objects that users bring: one file each in their data folder, read when asked for."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from backend.errors import InvalidInputError
from backend.files import data_folder
from backend.objects.description import ObjectDescription
from backend.objects.store import read_object, write_object

NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


def own_names() -> tuple[str, ...]:
    """Names of the user's objects, sorted; no file is opened."""
    names = (path.stem for path in (data_folder() / "objects").glob("*.npz"))
    return tuple(sorted(name for name in names if NAME.fullmatch(name)))


def own_file(name: str) -> Path:
    """Where the user's object of that name is kept."""
    return data_folder() / "objects" / f"{name}.npz"


def load_own(name: str) -> ObjectDescription:
    """The user's object as it is stored now; raises ``InvalidInputError`` when it cannot be read."""
    path = own_file(name)
    try:
        return _read(path, path.stat().st_mtime_ns)
    except OSError as error:
        raise InvalidInputError(f"{path}: cannot be read ({error.strerror}).") from error


def save_own(described: ObjectDescription) -> Path:
    """Keep an object, in place of one of the same name; its file. Raises ``InvalidInputError`` if it can't."""
    path = own_file(described.name)
    try:
        write_object(path, described)
    except OSError as error:
        raise InvalidInputError(f"Cannot write {path}: {error.strerror}.") from error
    return path


@lru_cache(maxsize=16)
def _read(path: Path, changed_ns: int) -> ObjectDescription:
    """``changed_ns`` tells apart what was stored under one name one after the other."""
    found = read_object(path)
    if found is None:
        again = f"python -m backend object add FILE --name {path.stem} --mass-kg KG --replace"
        raise InvalidInputError(f"{path}: not an object that this version can read. Add it again: {again}")
    return replace(found, name=path.stem)
