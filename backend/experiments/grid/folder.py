"""The folder of a grid: one store for all of it, and one for each shard that is run by itself."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

from backend.errors import InvalidInputError, NotFoundError
from backend.experiments.grid.cells import Beginning, Group, Plan, make_plan, up_to_date
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import hash_of, settings_from
from backend.experiments.grid.store import Facts, Store, open_store, read_store
from backend.experiments.grid.trial_set import starts_of

WHOLE = "grid.sqlite"
Shard = tuple[int, int]
"""i of n, i from 1."""


def store_file(folder: Path, shard: Shard = (1, 1)) -> Path:
    """Where the rows are kept."""
    return folder / (WHOLE if shard[1] == 1 else f"shard-{shard[0]}-of-{shard[1]}.sqlite")


def shard_files(folder: Path) -> list[Path]:
    """The shards that lie in a folder."""
    return sorted(folder.glob("shard-*-of-*.sqlite"))


def parse_shard(text: str) -> Shard:
    """``i/n``, i from 1 to n; raises ``InvalidInputError``."""
    first, slash, second = text.partition("/")
    if slash and first.isdecimal() and second.isdecimal() and 1 <= int(first) <= int(second):
        return int(first), int(second)
    raise InvalidInputError(f"--shard is i/n with i from 1 to n, such as 1/4 (got {text!r})")


def facts_of(plan: Plan, trial_set: str | None) -> Facts:
    """What the store says of the grid of a plan."""
    decided = plan.decided()
    return Facts(decided, plan.settings.judge, trial_set, hash_of(decided))


def open_grid(folder: Path, plan: Plan, trial_set: str | None, shard: Shard) -> Store:
    """The store of a plan in that folder for writing; errors as ``open_store``."""
    return open_store(store_file(folder, shard), facts_of(plan, trial_set))


def read_grid(folder: Path, *, check: bool = True) -> Store:
    """The store of all rows in a folder, for reading; errors as ``read_store``.

    Without ``check`` what is broken is met only when it is read.
    """
    if not folder.is_dir():
        raise NotFoundError(f"There is no folder {folder}; `python -m backend grid --out {folder}` makes it.")
    if not store_file(folder).is_file() and (shards := shard_files(folder)):
        raise NotFoundError(
            f"{folder} has {len(shards)} shards that are not merged yet: python -m backend merge {folder}"
        )
    return read_store(store_file(folder), even_broken=not check)


def plan_of(facts: Facts) -> Plan:
    """The plan of a store, made again from what it says of its settings.

    Raises ``InvalidInputError`` when the project's scenarios or methods are not those it was made with.
    """
    table = {name: value for name, value in facts.decided.items() if name != "conditions"}
    starts: dict[Group, tuple[Beginning, ...]] | None = None
    if facts.trial_set is not None:
        starts = starts_of(facts.trial_set, "the grid's trial set")
    plan = make_plan(settings_from({**table, "judge": facts.judge}, "the grid's settings"), starts)
    if plan.decided() != up_to_date(facts.decided):
        raise InvalidInputError("The scenarios or methods of this project are not those the grid was run with.")
    return plan


def trials_of(facts: Facts) -> int:
    """How many trials the grid of a store has, without making its plan."""
    decided = facts.decided
    if facts.trial_set is not None:
        return len(decided["methods"]) * sum(1 for _ in csv.DictReader(io.StringIO(facts.trial_set)))
    lengths = (len(decided[name]) for name in ("robots", "tasks", "objects", "methods"))
    return math.prod(lengths) * int(decided["trials"])


def salvaged(store: Store, most: int) -> list[GridRow]:
    """Every row that can still be read of a broken file that has at most so many."""
    rows = (store.row_number(number) for number in range(1, most + 1))
    return [row for row in rows if row is not None]
