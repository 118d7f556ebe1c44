"""Store: the rows of a grid in one SQLite file in WAL mode, each written once and whole, readable while it grows."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import IO, Any, Self, get_type_hints

from backend.errors import InvalidInputError, NotFoundError, StorageError
from backend.experiments.grid.cells import Key, up_to_date
from backend.experiments.grid.row import COLUMNS, GridRow
from backend.experiments.grid.settings import differences, hash_of
from backend.experiments.grid.writer import locked
from backend.files import replacing

FORMAT = 1
KEY = ("robot", "task", "object", "method", "index")
SQL_TYPES: dict[Any, str] = {
    str: "TEXT NOT NULL",
    bool: "INTEGER NOT NULL",
    int: "INTEGER NOT NULL",
    str | None: "TEXT",
    float | None: "REAL",
}
SQL_COLUMNS = ", ".join(f'"{name}" {SQL_TYPES[hint]}' for name, hint in get_type_hints(GridRow).items())
BUSY_S = 30.0


@dataclass(frozen=True)
class Facts:
    """What a store says of its grid."""

    decided: dict[str, Any]
    """Settings and conditions, see ``Plan.decided``."""
    judge: str
    trial_set: str | None
    """The trial set's CSV text, where the starts come from one."""
    settings: str
    """Hash of what was decided when the store was begun; all its rows have it, also when trials are added later."""


class Store:
    """The rows of one grid, or of one shard of it."""

    def __init__(self, path: Path, connection: sqlite3.Connection, facts: Facts, lock: IO[str] | None = None) -> None:
        self.path = path
        self.facts = facts
        self._db = connection
        self._lock = lock

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give file and lock back."""
        self._db.close()
        if self._lock is not None:
            self._lock.close()

    def add(self, row: GridRow) -> None:
        """Write a row, once and whole; raises ``StorageError`` when it can't be, and then nothing of it is there."""
        values = [getattr(row, name) for name in COLUMNS]
        with _explained(self.path):
            self._db.execute(f"INSERT INTO trials VALUES ({', '.join('?' * len(COLUMNS))})", values)

    def keys(self) -> set[Key]:
        """The trials that have a row."""
        with _explained(self.path):
            names = ", ".join(f'"{name}"' for name in KEY)
            return {Key(*values) for values in self._db.execute(f"SELECT {names} FROM trials")}

    def codes(self) -> set[str]:
        """Versions of the code that rows were made with."""
        with _explained(self.path):
            return {str(code) for (code,) in self._db.execute("SELECT DISTINCT code FROM trials")}

    def rows(self) -> Iterator[GridRow]:
        """All rows, in the order in which they were written."""
        with _explained(self.path):
            yield from map(row_of, self._db.execute("SELECT * FROM trials ORDER BY rowid"))

    def row(self, key: Key) -> GridRow:
        """The row of a trial; raises ``NotFoundError``."""
        where = " AND ".join(f'"{name}" = ?' for name in KEY)
        with _explained(self.path):
            values = [getattr(key, name) for name in KEY]
            found = self._db.execute(f"SELECT * FROM trials WHERE {where}", values).fetchone()
        if found is None:
            raise NotFoundError(f"{self.path} has no row of {key}.")
        return row_of(found)

    def query(self, sql: str, values: Sequence[object] = ()) -> list[Any]:
        """Every line of the answer to a question in SQL, as tuples; for readers."""
        with _explained(self.path):
            return self._db.execute(sql, values).fetchall()

    def row_number(self, number: int) -> GridRow | None:
        """The n-th row written; None when there is none or the file is broken there."""
        try:
            found = self._db.execute("SELECT * FROM trials WHERE rowid = ?", (number,)).fetchone()
            return None if found is None else row_of(found)
        except (sqlite3.DatabaseError, TypeError, ValueError):
            return None


def open_store(path: Path, facts: Facts) -> Store:
    """The store at ``path`` for writing, made if it is missing; nobody else writes to it until it is closed.

    One that was begun with fewer trials takes in the others. Raises ``InvalidInputError`` when it is of other settings
    (and says which), corrupt, in use, or can't be written.
    """
    with ExitStack() as opened:
        lock = opened.enter_context(locked(path))
        with _explained(path):
            if not path.exists() or path.stat().st_size == 0:
                _begin(path, facts)
            connection = opened.enter_context(closing(sqlite3.connect(path, isolation_level=None, timeout=BUSY_S)))
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
        _check_whole(path, connection)
        there = _facts(path, connection)
        check_same(path, there, facts)
        facts = replace(facts, settings=there.settings)
        if facts.decided != there.decided:
            with _explained(path):
                update = "UPDATE facts SET value = ? WHERE name = 'decided'"
                connection.execute(update, [json.dumps(facts.decided)])
        opened.pop_all()
        return Store(path, connection, facts, lock)


def read_store(path: Path, *, even_broken: bool = False) -> Store:
    """The store at ``path`` for reading, also while others write.

    Raises ``NotFoundError`` when there is none, ``InvalidInputError`` when it is corrupt (unless ``even_broken`` and
    its settings can still be read).
    """
    if not path.is_file():
        raise NotFoundError(f"There is no {path.name} in {path.parent}; `python -m backend grid` makes it.")
    with _explained(path):
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=BUSY_S)
    if not even_broken:
        _check_whole(path, connection)
    return Store(path, connection, _facts(path, connection))


def check_same(path: Path, there: Facts, asked: Facts) -> None:
    """Raise ``InvalidInputError`` when rows of one grid are not those of the other, that says how they differ."""
    if lines := differing(there, asked):
        raise InvalidInputError(
            f"{path} has rows of other settings; take another folder, or ask for the same:\n  " + "\n  ".join(lines)
        )


def differing(there: Facts, asked: Facts) -> list[str]:
    """How two grids differ, one line each.

    Fewer trials there are no difference: they are the first of those asked for.
    """
    decided = up_to_date(there.decided)
    if asked.trial_set is None and there.trial_set is None:
        decided["trials"] = max(decided["trials"], asked.decided["trials"])
    return differences(decided, up_to_date(asked.decided))


def _begin(path: Path, facts: Facts) -> None:
    """A store without rows, there in one step: who reads finds all of it or nothing."""
    key = ", ".join(f'"{name}"' for name in KEY)
    told = {"format": FORMAT, **asdict(facts)}
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as made:
        made.execute("CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT")
        made.execute(f"CREATE TABLE trials ({SQL_COLUMNS}, UNIQUE ({key})) STRICT")
        made.executemany("INSERT INTO facts VALUES (?, ?)", [(name, json.dumps(value)) for name, value in told.items()])
        with replacing(path) as file:
            file.write(made.serialize())


def _check_whole(path: Path, connection: sqlite3.Connection) -> None:
    with _explained(path):
        found = [str(line[0]) for line in connection.execute("PRAGMA quick_check(3)")]
    if found != ["ok"]:
        raise _corrupt(path, "; ".join(found))


def _facts(path: Path, connection: sqlite3.Connection) -> Facts:
    with _explained(path):
        told = {name: json.loads(value) for name, value in connection.execute("SELECT name, value FROM facts")}
    if told.get("format") != FORMAT:
        raise InvalidInputError(f"{path}: format {told.get('format')}; this version reads {FORMAT}.")
    settings = told.get("settings") or hash_of(told["decided"])
    return Facts(told["decided"], told["judge"], told["trial_set"], settings)


@contextmanager
def _explained(path: Path) -> Generator[None]:
    """SQLite's errors as ours."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        name = str(getattr(error, "sqlite_errorname", ""))
        if name.startswith(("SQLITE_CORRUPT", "SQLITE_NOTADB")) or "no such table" in str(error):
            raise _corrupt(path, str(error)) from error
        if name.startswith(("SQLITE_FULL", "SQLITE_IOERR")):
            raise StorageError(
                f"{path} cannot be written ({error}): is the disk full? What was written is kept."
            ) from error
        raise InvalidInputError(f"{path}: {error}.") from error
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror}.") from error


def _corrupt(path: Path, why: str) -> InvalidInputError:
    return InvalidInputError(
        f"{path} is corrupt ({why}). What can be read of it is moved to a new folder by: "
        f"python -m backend merge NEW_FOLDER {path.parent} --salvage"
    )


def row_of(values: Any) -> GridRow:
    """A line of the table, columns in their order, as a row."""
    table: dict[str, Any] = dict(zip(COLUMNS, values, strict=True))
    table["strict"], table["authors"] = bool(table["strict"]), bool(table["authors"])
    return GridRow(**table)
