"""Panel: one group of widgets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import viser

from app.history import Moment
from app.state import SessionState
from app.ui.desk import Desk
from app.ui.progress import Tally


@dataclass(frozen=True, eq=False)
class View:
    """What the panels show."""

    state: SessionState
    """As at the moment looked at."""
    live: SessionState
    """As it is now; the same while nobody looks back."""
    moments: tuple[Moment, ...]
    """The last minute, oldest first."""
    tally: Tally
    next_in_s: float | None
    """Seconds until the next trial begins by itself; None when it will not."""
    status_line: str


class Panel(Protocol):
    """Builds its widgets once. ``show`` is the only place where it sets them; callbacks only leave wishes."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None: ...

    def show(self, view: View) -> None:
        """A few times a second."""
        ...
