"""Trial sets: how trials begin, as a CSV table, so that anybody's benchmark can be run here and ours elsewhere."""

from __future__ import annotations

import csv
import difflib
import hashlib
import io
import math
from collections.abc import Iterable
from pathlib import Path

from pydantic import ValidationError

from backend.drawing import arm_at_home, drawn_setup
from backend.errors import InvalidInputError
from backend.experiments.grid.conditions import (
    CIRCLE,
    END,
    OBJECT,
    OBSTACLES,
    SLAB,
    SPEEDS,
    SWING,
    Conditions,
    conditions_of,
    needed,
    place_columns,
    setup_of,
)
from backend.experiments.grid.ranges import complaint_of
from backend.objects import load_object, object_names
from backend.robots import ROBOTS
from backend.scenario import Scenario
from backend.tasks import TASKS
from backend.tasks.clearance import can_begin

NAMES = ("robot", "task", "object")
OBSTACLE_NAMES = tuple(f"obstacle_{i + 1}" for i in range(OBSTACLES))
OBSTACLE_COLUMNS = tuple(column for i, name in enumerate(OBSTACLE_NAMES) for column in (name, *place_columns(i)))
COLUMNS = (*NAMES, "seed", *OBJECT, *SPEEDS, *END, *SWING, *CIRCLE, *SLAB, *OBSTACLE_COLUMNS)
SHORTEST_M = 0.05
"""Of belts and radii."""
MUST = (*NAMES, "seed", *OBJECT, *SPEEDS)
"""Columns that every file has; the others, where a task of the file needs them."""


def drawn_set(scenario: Scenario, objects: Iterable[str], trials: int, first_seed: int) -> list[Conditions]:
    """How the trials of these seeds begin, with each object."""
    out: list[Conditions] = []
    for name in objects:
        of_object = scenario.model_copy(update={"object": name})
        for seed in range(first_seed, first_seed + trials):
            setup = drawn_setup(of_object, seed)
            out.append(conditions_of(scenario.robot, scenario.task.kind, name, seed, setup))
    return out


def to_csv(rows: Iterable[Conditions]) -> str:
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


def starts_of(text: str, where: str) -> dict[tuple[str, str, str], tuple[tuple[int, Conditions | None], ...]]:
    """Robot, task, object -> seed and conditions of each trial, in the order of the rows.

    Raises ``InvalidInputError`` with file, line and column of everything that is wrong (of the first 20).
    """
    reader = csv.DictReader(io.StringIO(text))
    _check_header(reader.fieldnames or (), where)
    groups: dict[tuple[str, str, str], list[tuple[int, Conditions | None]]] = {}
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
            groups.setdefault((row.robot, row.task, row.object), []).append((row.seed, row))
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


def _parsed(cells: dict[str, str | None]) -> tuple[Conditions | None, list[str]]:
    """A row, or what is wrong with it, each beginning with its column."""
    texts = {name: (text or "").strip() for name, text in cells.items()}
    tables = {"robot": tuple(ROBOTS), "task": tuple(TASKS), "object": object_names()}
    wrong = [
        f"column {name}: there is no {name} {texts[name]!r}; there are {', '.join(table)}"
        for name, table in tables.items()
        if texts[name] not in table
    ]
    if wrong:
        return None, wrong
    if not texts["seed"].isdecimal():
        wrong.append(f"column seed: {texts['seed']!r} is not a whole number from 0 on")
    obstacles = [texts[name] for name in OBSTACLE_NAMES if texts.get(name)]
    wrong += [
        f"column obstacle_{i + 1}: there is no object {name!r}; there are {', '.join(object_names())}"
        for i, name in enumerate(obstacles)
        if name not in object_names()
    ]
    numbers: dict[str, float] = {}
    columns = needed(texts["task"], len(obstacles))
    for name in columns:
        complaint = complaint_of(name, texts.get(name, ""))
        if complaint is None:
            numbers[name] = float(texts[name])
        else:
            wrong.append(f"column {name}: {complaint}")
    fitting = (*NAMES, "seed", *columns, *OBSTACLE_NAMES)
    wrong += [
        f"column {name}: the task {texts['task']} has none" for name in texts if texts[name] and name not in fitting
    ]
    if wrong:
        return None, wrong
    return Conditions(texts["robot"], texts["task"], texts["object"], int(texts["seed"]), numbers, tuple(obstacles)), []


def _cannot_begin(row: Conditions) -> list[str]:
    """Why no trial can begin so, if none can."""
    n = row.numbers
    other = CIRCLE[:2] if row.task == "circular" else END[:2]
    length_m = math.dist([n[name] for name in OBJECT[:2]], [n[name] for name in other])
    if length_m < SHORTEST_M:
        what = "circle's radius is" if row.task == "circular" else "belt is"
        return [f"columns {', '.join(other)}: the {what} only {length_m:g} m; metres are wanted"]
    try:
        setup = setup_of(row)
    except ValidationError as error:
        return [f"columns {', '.join((*OBJECT, *other))}: {error.errors()[0]['msg']}"]
    if can_begin(setup, load_object(row.object), arm_at_home(row.robot)):
        return []
    return [f"columns {', '.join(OBJECT[:3])}: object, tray or slab would start in the arm or run into its base"]


def _cells(row: Conditions) -> dict[str, str]:
    names = dict(zip(OBSTACLE_NAMES, row.obstacles, strict=False))
    plain = {"robot": row.robot, "task": row.task, "object": row.object, "seed": str(row.seed)}
    return {**plain, **names, **{name: repr(value) for name, value in row.numbers.items()}}
