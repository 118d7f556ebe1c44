"""Trial sets: how trials begin, as a CSV table, so that anybody's benchmark can be run here and ours elsewhere."""

from __future__ import annotations

import csv
import difflib
import hashlib
import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from backend.drawing import placed_setup, setup_of_seed
from backend.errors import InvalidInputError
from backend.objects import object_names
from backend.robots import ROBOTS
from backend.scenario import Scenario
from backend.tasks import TASKS
from backend.tasks.start import (
    CIRCLE,
    END,
    OBJECT,
    OBSTACLE_NAMES,
    SLAB,
    SPEEDS,
    SWING,
    Start,
    place_columns,
    read_start,
    start_of,
)

NAMES = ("robot", "task", "object")
OBSTACLE_COLUMNS = tuple(column for i, name in enumerate(OBSTACLE_NAMES) for column in (name, *place_columns(i)))
COLUMNS = (*NAMES, "seed", *OBJECT, *SPEEDS, *END, *SWING, *CIRCLE, *SLAB, *OBSTACLE_COLUMNS)
MUST = (*NAMES, "seed", *OBJECT, *SPEEDS)
"""Columns that every file has; the others, where a task of the file needs them."""


@dataclass(frozen=True)
class Row:
    """One trial."""

    robot: str
    task: str
    object: str
    seed: int
    """Of the sensor's noise and the planner's chance."""
    start: Start


def drawn_set(scenario: Scenario, objects: Iterable[str], trials: int, first_seed: int) -> list[Row]:
    """How the trials of these seeds begin, with each object."""
    out: list[Row] = []
    for name in objects:
        of_object = scenario.model_copy(update={"object": name})
        for seed in range(first_seed, first_seed + trials):
            out.append(Row(scenario.robot, scenario.task.kind, name, seed, start_of(setup_of_seed(of_object, seed))))
    return out


def to_csv(rows: Iterable[Row]) -> str:
    """The table; numbers with all their digits. Columns that no row has are left out."""
    listed = list(rows)
    used = {name for row in listed for name in _cells(row)}
    text = io.StringIO()
    writer = csv.DictWriter(text, [name for name in COLUMNS if name in used], restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(_cells(row) for row in listed)
    return text.getvalue()


def read_trial_set(path: Path) -> str:
    """The text of a file; raises ``InvalidInputError`` when it can't be read."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InvalidInputError(f"The trial set {path} cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError as error:
        raise InvalidInputError(f"The trial set {path} is not UTF-8 text (byte {error.start}).") from None


def sha256_of(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def starts_of(text: str, where: str) -> dict[tuple[str, str, str], tuple[tuple[int, Start | None], ...]]:
    """Robot, task, object -> seed and start of each trial, in the order of the rows.

    Raises ``InvalidInputError`` with file, line and column of everything that is wrong (of the first 20).
    """
    reader = csv.DictReader(io.StringIO(text))
    _check_header(reader.fieldnames or (), where)
    groups: dict[tuple[str, str, str], list[tuple[int, Start | None]]] = {}
    wrong: list[str] = []
    for cells in reader:
        at = f"{where}, line {reader.line_num}"
        if reader.restkey in cells:
            wrong.append(f"{at}: more values than columns")
            break
        row, complaints = _parsed(cells)
        wrong += [f"{at}, {complaint}" for complaint in complaints]
        if row is not None and not wrong:
            wrong += [f"{at}, {complaint}" for complaint in _cannot_begin(row)]
            groups.setdefault((row.robot, row.task, row.object), []).append((row.seed, row.start))
        if len(wrong) >= 20:
            break
    if wrong:
        raise InvalidInputError("\n".join(wrong))
    if not groups:
        raise InvalidInputError(f"{where} has no rows.")
    return {group: tuple(starts) for group, starts in groups.items()}


def _check_header(header: Iterable[str], where: str) -> None:
    names = list(header)
    if missing := [name for name in MUST if name not in names]:
        raise InvalidInputError(f"{where}, line 1: columns {', '.join(missing)} are missing.")
    for name in names:
        if name not in COLUMNS:
            near = difflib.get_close_matches(name, COLUMNS, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else f" There are: {', '.join(COLUMNS)}."
            raise InvalidInputError(f"{where}, line 1: there is no column {name!r}.{hint}")


def _parsed(cells: dict[str, str | None]) -> tuple[Row | None, list[str]]:
    """A row, or what is wrong with it, each beginning with its column."""
    texts = {name: (text or "").strip() for name, text in cells.items()}
    robot, task, object, seed = (texts.pop(name) for name in (*NAMES, "seed"))
    wrong = [
        f"column {name}: there is no {name} {said!r}; there are {', '.join(table)}"
        for name, said, table in (("robot", robot, ROBOTS), ("task", task, TASKS), ("object", object, object_names()))
        if said not in table
    ]
    if wrong:
        return None, wrong
    if not seed.isdecimal():
        wrong.append(f"column seed: {seed!r} is not a whole number from 0 on")
    start, complaints = read_start(task, texts)
    wrong += [f"column{'s' * (', ' in column)} {column}: {complaint}" for column, complaint in complaints]
    return (None, wrong) if wrong else (Row(robot, task, object, int(seed), start), [])


def _cannot_begin(row: Row) -> list[str]:
    """Why no trial can begin so, if none can."""
    try:
        placed_setup(row.start, row.robot, row.task, row.object)
    except InvalidInputError as error:
        return [f"columns {', '.join(OBJECT[:3])}: {error}"]
    return []


def _cells(row: Row) -> dict[str, str]:
    plain = {"robot": row.robot, "task": row.task, "object": row.object, "seed": str(row.seed)}
    return plain | {name: value if isinstance(value, str) else repr(value) for name, value in row.start.items()}
