"""SessionState: everything the page and the API may know of the simulation, at one moment."""

from __future__ import annotations

import signal
from dataclasses import dataclass, field, replace
from typing import Literal

from app.commands import Restart
from app.engine import Keepsake, TrialInfo
from app.history import Moment, newest
from app.reports import Crashed, Pace, Sight, Started, Traces
from app.view import SharedView
from backend.errors import GraspingError, InvalidInputError
from backend.events import TimedEvent
from backend.snapshot import Snapshot

Status = Literal["starting", "running", "crashed"]


class SimulationDownError(GraspingError):
    """A command for a simulation process that has crashed."""


@dataclass(frozen=True, eq=False)
class SessionState:
    """Immutable; the session replaces it whole."""

    status: Status
    info: TrialInfo
    """What was asked for last."""
    restart: Restart
    """The command that asked for it."""
    loading: bool
    """A new episode was asked for and has not begun."""
    pace: Pace
    view: SharedView = field(default_factory=SharedView)
    """The page's and scripts' own; nothing in the simulation knows of it."""
    started: Started | None = None
    snapshot: Snapshot | None = None
    """Newest tick of the running episode; its ``cycle`` is filled in."""
    traces: Traces | None = None
    """Of the newest cycle."""
    beside: Sight | None = None
    """The same of the episode compared with; None while nothing is compared."""
    looked_at: Moment | None = None
    """An earlier moment that is shown instead of the newest."""
    events: tuple[TimedEvent, ...] = ()
    """Live edits of the running episode."""
    keepsake: Keepsake | None = None
    """Of the running episode, once it has ended."""
    keepsake_beside: Keepsake | None = None
    """Of the episode compared with, once it has ended."""
    crash: Crashed | None = None
    refusals: tuple[int, str] = (0, "")
    """How many commands were refused so far, and what was said to the last."""

    @property
    def shown(self) -> SessionState:
        """This state as it was at the moment looked at."""
        moment = self.looked_at
        if moment is None:
            return self
        return replace(self, snapshot=moment.snapshot, traces=moment.traces, beside=moment.beside)

    @property
    def newest(self) -> Snapshot | None:
        """Of the episode that has come furthest."""
        return None if self.snapshot is None else newest(self.snapshot, self.beside)

    @property
    def over(self) -> bool:
        """Whether every episode has ended."""
        worlds = [self.snapshot, *([] if self.beside is None else [self.beside.snapshot])]
        return all(snapshot is not None and snapshot.outcome is not None for snapshot in worlds)

    @property
    def repeated(self) -> Restart:
        """The command that leads to the running episode again, live edits included."""
        return self.restart.model_copy(update={"events": self.events, "from_tick": 0})

    def gone_on_with(self) -> Restart:
        """The command that leads to the moment looked at again, which a seed makes exact.

        Raises ``InvalidInputError`` when there is no such moment, or no way to be there again.
        """
        if self.looked_at is None:
            raise InvalidInputError("Choose an earlier moment first; what is shown is the newest.")
        if self.info.values.timing.think == "measured":
            raise InvalidInputError(
                "With measured thinking time no trial comes out twice the same: set think to budget or paper."
            )
        tick = self.looked_at.tick
        before = tuple(timed for timed in self.events if timed.tick < tick)
        return self.restart.model_copy(update={"events": before, "from_tick": tick})


def cause_of_end(exit_code: int | None) -> str:
    """Why a process has ended, from its exit code."""
    if exit_code is not None and exit_code < 0:
        name = signal.Signals(-exit_code).name
        return f"The simulation process was ended by {name}: killed from outside or crashed natively."
    return f"The simulation process ended by itself with exit code {exit_code}."
