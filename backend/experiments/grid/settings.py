"""GridSettings: which trials a grid has and under which conditions they run, from flags or a TOML file."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator
from pydantic_core import PydanticCustomError

from backend.config import Config, complaint
from backend.errors import InvalidInputError
from backend.methods import METHODS
from backend.objects import OBJECTS, object_names
from backend.robots import ROBOTS
from backend.robots.description import ProfileName
from backend.scenario.model import known
from backend.tasks import TASKS

PAPERS_METHODS = ("ours_rm", "reachability", "motion_aware", "baseline", "no_seeding", "no_prediction")
"""In the order of the paper's table."""
JudgeName = Literal["strict", "authors"]
MOST_LINES = 12
NAMES = ("robots", "tasks", "objects", "methods")


class GridSettings(Config):
    """Everything that decides what the rows of a grid are; two grids with equal settings have equal rows."""

    robots: tuple[str, ...] = tuple(ROBOTS)
    tasks: tuple[str, ...] = tuple(TASKS)
    objects: tuple[str, ...] = tuple(OBJECTS)
    methods: tuple[str, ...] = PAPERS_METHODS
    trials: Annotated[int, Field(ge=1, le=1_000_000)] = 100
    """Of each robot, task, object and method."""
    first_seed: Annotated[int, Field(ge=0, lt=2**62)] = 0
    """Of trial 0; trial i has the i-th after it."""
    profile: ProfileName = "paper"
    think: Literal["budget", "paper"] = "budget"
    """What a cycle costs. ``measured`` is not offered: its rows would depend on the machine."""
    set: tuple[str, ...] = ()
    """``path=value`` for every scenario, as ``--set`` of ``trial``."""
    trials_sha256: str | None = None
    """Of the trial set that the starts are taken from; None: drawn from the seeds."""
    judge: JudgeName = "strict"
    """Whose successes are shown; rows have both, so this decides nothing."""

    @field_validator(*NAMES, "set", mode="before")
    @classmethod
    def _list_is_fine(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    @field_validator(*NAMES)
    @classmethod
    def _names_are_known_once(cls, names: tuple[str, ...], info: Any) -> tuple[str, ...]:
        table: Mapping[str, object] = {
            "robots": ROBOTS,
            "tasks": TASKS,
            "objects": dict.fromkeys(object_names()),
            "methods": METHODS,
        }[info.field_name]
        if not names:
            raise PydanticCustomError("no_names", "at least one is needed")
        for name, count in Counter(names).items():
            known(info.field_name[:-1], name, table)
            if count > 1:
                raise PydanticCustomError("twice", "{name} is listed {count} times", {"name": name, "count": count})
        return names

    def deciding(self) -> dict[str, Any]:
        """What decides the rows, as a plain table."""
        return self.model_dump(mode="json", exclude={"judge"})


def settings_from(table: Mapping[str, Any], where: str = "") -> GridSettings:
    """The settings of a plain table; raises ``InvalidInputError`` with one line per mistake, led by ``where``."""
    try:
        return GridSettings.model_validate(dict(table))
    except ValidationError as error:
        lead = f"{where}: " if where else ""
        lines = [lead + _sentence(entry) for entry in error.errors(include_url=False)]
        raise InvalidInputError("\n".join(lines)) from None


def read_grid_file(path: Path) -> dict[str, Any]:
    """The words of a grid file; raises ``InvalidInputError`` when it can't be read."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InvalidInputError(f"The grid file {path} cannot be read: {error.strerror}.") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InvalidInputError(f"The grid file {path} is not valid TOML: {error}") from None


def hash_of(decided: Mapping[str, Any]) -> str:
    """16 hexadecimal digits of a plain table, whatever the order of its keys."""
    return hashlib.sha256(json.dumps(decided, sort_keys=True).encode()).hexdigest()[:16]


def differences(there: Mapping[str, Any], asked: Mapping[str, Any]) -> list[str]:
    """Where two tables of settings differ: ``path: X there, Y asked for``, one line each.

    Conditions are named only when the words of the grid are the same, and the first few of them.
    """
    words = _differing(_words(there), _words(asked))
    return words or _differing(there, asked)[:MOST_LINES]


def _words(table: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in table.items() if name != "conditions"}


def _differing(there: Any, asked: Any, path: str = "") -> list[str]:
    if isinstance(there, dict) and isinstance(asked, dict):
        lines: list[str] = []
        for key in dict.fromkeys([*there, *asked]):
            below = f"{path}.{key}" if path else str(key)
            lines += _differing(there.get(key), asked.get(key), below)
        return lines
    return [] if there == asked else [f"{path}: {_shown(there)} there, {_shown(asked)} asked for"]


def _shown(value: Any) -> str:
    return "nothing" if value is None else json.dumps(value)


def _sentence(entry: Any) -> str:
    if entry["type"] == "extra_forbidden":
        name = str(entry["loc"][-1])
        return f"{name}: there is no such word; there are {', '.join(GridSettings.model_fields)}"
    if entry["type"] in ("unknown_name", "no_names", "twice"):
        return f"{entry['loc'][0]}: {entry['msg']}"
    return complaint(entry)
