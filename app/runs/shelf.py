"""Shelf: the folder of all runs; the only place where a name from outside becomes a path."""

from __future__ import annotations

import re
from pathlib import Path

from backend.errors import InvalidInputError, NotFoundError, not_found_text

NAME = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"
"""Names of runs: no dots, no slashes, nothing hidden."""
MOST = 500


class Shelf:
    """Every folder in ``root`` whose name may be that of a run."""

    def __init__(self, root: Path) -> None:
        self.root = root.absolute()

    def names(self) -> list[str]:
        """The folders there are, by name; none when there is no ``root``. Raises ``InvalidInputError``."""
        if not self.root.exists():
            return []
        try:
            found = sorted(entry.name for entry in self.root.iterdir() if entry.is_dir() and self._may_be(entry.name))
        except OSError as error:
            raise InvalidInputError(f"The folder of runs {self.root} cannot be read: {error.strerror}.") from None
        return found[:MOST]

    def path(self, name: str) -> Path:
        """The folder of a run that is there; raises ``NotFoundError``."""
        names = self.names()
        if name not in names:
            raise NotFoundError(not_found_text("run", name, names))
        return self.root / name

    def new_path(self, name: str) -> Path:
        """Where a run of that name is or would be; raises ``InvalidInputError`` for a name that none may have."""
        if not self._may_be(name):
            raise InvalidInputError(
                f"A run's name has 1 to 64 letters, digits, - or _, and stays inside {self.root} (got {name!r})."
            )
        return self.root / name

    def _may_be(self, name: str) -> bool:
        """Whether it is a name, and not one of a link that leads elsewhere."""
        return re.fullmatch(NAME, name) is not None and not (self.root / name).is_symlink()
