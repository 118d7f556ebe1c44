"""The error tree: every exception this project raises on purpose, and the look-up that names what exists."""

import difflib
from collections.abc import Iterable, Mapping
from typing import TypeVar

T = TypeVar("T")


class GraspingError(Exception):
    """Base of everything raised on purpose; its text says what, where, and what would have worked."""


class NotFoundError(GraspingError):
    """A name that no table knows."""


class InvalidInputError(GraspingError):
    """A value, flag, request or file that people wrote and that cannot be used."""


class MissingResourceError(GraspingError):
    """A package or file the project needs is not where it should be."""


class StorageError(GraspingError):
    """Results cannot be written any more; what was written before is kept."""


class SimulationError(GraspingError):
    """The simulated world left the realm of numbers (diverged, or was used after it was closed)."""


def lookup(kind: str, name: str, table: Mapping[str, T]) -> T:
    """Return ``table[name]``; raise ``NotFoundError`` naming what exists and the nearest spelling."""
    if name in table:
        return table[name]
    raise NotFoundError(not_found_text(kind, name, table))


def not_found_text(kind: str, name: str, available: Iterable[str]) -> str:
    """One sentence for an unknown name: what was asked, what exists, what was probably meant."""
    names = sorted(available)
    near = difflib.get_close_matches(name, names, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return f"There is no {kind} named {name!r}. Available: {', '.join(names) or '(none)'}.{hint}"
