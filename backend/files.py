"""Files written whole or not at all, and the folders where a user's are kept."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from backend.errors import InvalidInputError


def cache_folder() -> Path:
    """Where what can be made again is kept: ``$XDG_CACHE_HOME`` or ``~/.cache``, then ``dynamic-grasping``."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "dynamic-grasping"


def data_folder() -> Path:
    """Where a user's own objects and their grasps are kept, which nothing can make again: ``$XDG_DATA_HOME`` or
    ``~/.local/share``, then ``dynamic-grasping``."""
    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(base) / "dynamic-grasping"


@contextmanager
def replacing(path: Path) -> Generator[BinaryIO]:
    """A new file that takes the place of ``path`` in one step when the block ends, and vanishes if it raises.

    Folders on the way are made. Raises ``OSError`` when the folder cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, aside = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        Path(aside).chmod(0o644)
        os.replace(aside, path)
    finally:
        Path(aside).unlink(missing_ok=True)


def remove(path: Path) -> None:
    """Remove a file, if it is there; raises ``InvalidInputError`` when it stays."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise InvalidInputError(f"Cannot remove {path}: {error.strerror}.") from error
