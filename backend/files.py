"""Files written whole or not at all, and the folder where a user's made-up ones are kept."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


def cache_folder() -> Path:
    """Where this user's models are kept: ``$XDG_CACHE_HOME`` or ``~/.cache``, then ``dynamic-grasping``."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
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
