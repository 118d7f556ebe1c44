"""Look: what is known of one run, read from its store while others may be writing to it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from backend.errors import GraspingError, NotFoundError
from backend.experiments.grid.folder import read_grid, shard_files, store_file, trials_of
from backend.experiments.grid.queries import CellCount, Pace, cell_counts, pace_of, reason_counts, rows_so_far
from backend.experiments.grid.settings import JudgeName
from backend.experiments.grid.store import Facts
from backend.experiments.grid.writer import writing_since

State = Literal["running", "stopped", "complete", "unreadable", "foreign"]
UNKNOWN_PACE = Pace(None, None)


@dataclass(frozen=True)
class Look:
    """One run at one moment."""

    name: str
    state: State
    """``stopped`` can be gone on with; ``foreign`` is a folder without a grid; ``unreadable`` is a broken one."""
    note: str = ""
    """Why it can't be read."""
    facts: Facts | None = None
    judge: JudgeName = "strict"
    trials: int = 0
    cells: tuple[CellCount, ...] = ()
    reasons: tuple[tuple[str, int], ...] = ()
    pace: Pace = UNKNOWN_PACE
    file: int = 0
    """Which file it was read from; another one has other rows."""

    @property
    def done(self) -> int:
        return sum(cell.n for cell in self.cells)

    @property
    def errors(self) -> int:
        return sum(cell.errors for cell in self.cells)

    def successes(self) -> int:
        """By the run's own judge."""
        return sum(cell.strict if self.judge == "strict" else cell.authors for cell in self.cells)


def look_at(folder: Path, now_s: float, before: Look | None = None) -> Look:
    """What there is in the folder of a run; whatever is wrong with it is told, not raised.

    Rows are counted again only when some have come since ``before``.
    """
    name = folder.name
    if not store_file(folder).is_file() and not shard_files(folder):
        if writing_since(store_file(folder)) is not None:
            return Look(name, "running", "It is being made.")
        return Look(name, "foreign", "This folder has no rows of a grid.")
    try:
        return _read(folder, now_s, before)
    except NotFoundError as error:  # shards that are not merged
        return Look(name, "unreadable", str(error))
    except (GraspingError, KeyError, TypeError, ValueError) as error:
        return Look(name, "unreadable", str(error) or type(error).__name__)


def _read(folder: Path, now_s: float, before: Look | None) -> Look:
    begun_s = writing_since(store_file(folder))
    with read_grid(folder, check=False) as store:
        facts, file, done = store.facts, store.path.stat().st_ino, rows_so_far(store)
        if before is not None and (before.file, before.done, before.facts) == (file, done, facts):
            cells, reasons = before.cells, before.reasons
        else:
            cells, reasons = tuple(cell_counts(store)), tuple(reason_counts(store).items())
        trials = trials_of(facts)
        pace = Pace(None, None) if begun_s is None else pace_of(store, trials - done, begun_s, now_s)
    state: State = "running" if begun_s is not None else "complete" if done >= trials else "stopped"
    judge: JudgeName = "authors" if facts.judge == "authors" else "strict"
    return Look(folder.name, state, "", facts, judge, trials, cells, reasons, pace, file)
