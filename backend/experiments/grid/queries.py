"""Queries: what readers ask of a store while it grows, answered by SQLite and bounded."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal

from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName
from backend.experiments.grid.store import Store, row_of

RECENT_S = 180.0
"""The rate of a running grid is that of its last so many seconds."""
MOST_ROWS = 200
KEY_ORDER = '"robot", "task", "object", "method", "index"'
Order = Literal["key", "newest"]


@dataclass(frozen=True)
class CellCount:
    """How the trials of one robot, task and method went so far."""

    robot: str
    task: str
    method: str
    n: int
    strict: int
    """Successes by the strict rule."""
    authors: int
    errors: int


@dataclass(frozen=True)
class Wanted:
    """Which rows; None is any."""

    robot: str | None = None
    task: str | None = None
    object: str | None = None
    method: str | None = None
    success: bool | None = None
    """By ``judge``."""
    reason: str | None = None
    judge: JudgeName = "strict"


@dataclass(frozen=True)
class Pace:
    """How quickly rows come."""

    per_s: float | None
    """None while too few have come."""
    left_s: float | None
    """Until all are there, if it goes on so."""


def rows_so_far(store: Store) -> int:
    """How many there are, without looking at them: rows are never taken away."""
    ((newest,),) = store.query("SELECT max(rowid) FROM trials")
    return newest or 0


def cell_counts(store: Store) -> list[CellCount]:
    """Every cell that has rows."""
    sql = (
        'SELECT "robot", "task", "method", count(*), sum("strict"), sum("authors"), sum("reason" IS \'error\') '
        'FROM trials GROUP BY "robot", "task", "method"'
    )
    return [CellCount(*values) for values in store.query(sql)]


def reason_counts(store: Store) -> dict[str, int]:
    """How often each reason of failure by the strict rule, the most frequent first."""
    sql = 'SELECT "reason", count(*) FROM trials WHERE "reason" IS NOT NULL GROUP BY "reason" ORDER BY 2 DESC, 1'
    return {str(reason): int(count) for reason, count in store.query(sql)}


def page_of(
    store: Store, wanted: Wanted, offset: int = 0, limit: int = 50, order: Order = "key"
) -> tuple[int, list[GridRow]]:
    """How many rows are wanted, and at most ``MOST_ROWS`` of them."""
    where, values = _conditions(wanted)
    ((total,),) = store.query(f"SELECT count(*) FROM trials{where}", values)
    by = KEY_ORDER if order == "key" else "rowid DESC"
    sql = f"SELECT * FROM trials{where} ORDER BY {by} LIMIT ? OFFSET ?"
    found = store.query(sql, [*values, min(max(limit, 0), MOST_ROWS), max(offset, 0)])
    return int(total), [row_of(values) for values in found]


def pace_of(store: Store, missing: int, begun_s: float, now_s: float) -> Pace:
    """The pace of a grid that has run since ``begun_s`` and lacks so many rows; POSIX seconds."""
    since = datetime.fromtimestamp(max(begun_s, now_s - RECENT_S), UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    ((n, first),) = store.query('SELECT count(*), min("finished") FROM trials WHERE "finished" >= ?', [since])
    if n < 2:
        return Pace(None, None)
    span_s = now_s - datetime.fromisoformat(first).timestamp()
    per_s = (n - 1) / max(span_s, 1.0)
    return Pace(per_s, missing / per_s)


def _conditions(wanted: Wanted) -> tuple[str, list[object]]:
    """A WHERE clause, empty when everything is wanted, and the values of its question marks."""
    columns = ("robot", "task", "object", "method", "reason")
    named: Iterable[tuple[str, object]] = ((name, getattr(wanted, name)) for name in columns)
    parts = [(name, value) for name, value in named if value is not None]
    if wanted.success is not None:
        parts.append((wanted.judge, wanted.success))
    clause = " AND ".join(f'"{name}" = ?' for name, _ in parts)
    return (f" WHERE {clause}" if clause else ""), [value for _, value in parts]
