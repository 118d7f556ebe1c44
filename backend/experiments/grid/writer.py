"""Writer: who may write to a store, one at a time, and whether somebody does."""

from __future__ import annotations

import fcntl
import os
import time
from pathlib import Path
from typing import IO

from backend.errors import InvalidInputError

TRIES = 5
BETWEEN_TRIES_S = 0.05
"""Whoever only asks whether somebody writes is quicker than this."""


def lock_file(path: Path) -> Path:
    """Beside the store at ``path``; its time of change is when writing began last."""
    return path.with_name(f".{path.name}.lock")


def locked(path: Path) -> IO[str]:
    """The right to write to the store at ``path`` until it is closed.

    Raises ``InvalidInputError`` when another has it, or the folder can't be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = open(lock_file(path), "a")
    except OSError as error:
        raise InvalidInputError(f"Cannot write to the folder {path.parent}: {error.strerror}.") from None
    for _ in range(TRIES):
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.utime(lock.fileno())
            return lock
        except OSError:
            time.sleep(BETWEEN_TRIES_S)
    lock.close()
    raise InvalidInputError(f"Another grid is writing to {path}; wait for it or take another folder.")


def writing_since(path: Path) -> float | None:
    """When the one who writes to the store at ``path`` began (POSIX seconds); None when nobody does."""
    try:
        with open(lock_file(path)) as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except OSError:
                return lock_file(path).stat().st_mtime
    except OSError:
        return None
    return None
