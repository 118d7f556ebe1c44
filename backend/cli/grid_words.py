"""What is asked of ``grid``: the words of flags and of a grid file, flags first, as settings, plan and shard."""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from backend.config import Config, explain
from backend.errors import InvalidInputError
from backend.experiments.grid.cells import Plan, make_plan
from backend.experiments.grid.folder import Shard, parse_shard
from backend.experiments.grid.settings import GridSettings, read_grid_file, settings_from
from backend.experiments.grid.trial_set import read_trial_set, sha256_of, starts_of

BY_THE_SET = ("robots", "tasks", "objects", "trials", "first_seed")
"""What a trial set says, and so nothing else may."""


class RunWords(Config):
    """How a grid is run; none of it decides what the rows are."""

    out: str
    """The folder."""
    workers: Annotated[int, Field(ge=1)] | None = None
    """None: one per core."""
    executor: Literal["local", "ray"] = "local"
    ray_address: str | None = None
    """Of a Ray cluster; None: one is started here."""
    limit_s: Annotated[float, Field(gt=0.0)] = 300.0
    """Wall time after which a trial counts as stuck."""
    trials_file: str | None = None
    """A trial set to take the starts from."""


@dataclass(frozen=True)
class Asked:
    """A grid as asked for."""

    words: RunWords
    plan: Plan
    trial_set: str | None
    shard: Shard

    @property
    def folder(self) -> Path:
        return Path(self.words.out)


def asked_for(options: argparse.Namespace) -> Asked:
    """Settings, plan and shard of flags and file; flags win."""
    where = options.file or ""
    table = {} if options.file is None else read_grid_file(Path(options.file))
    names = (*RunWords.model_fields, *GridSettings.model_fields)
    flags = {name: getattr(options, name, None) for name in names}
    table |= {name: value for name, value in flags.items() if value is not None}
    if "trials_sha256" in table:
        raise InvalidInputError("trials_sha256 is worked out; name the trial set by trials_file")
    words = _run_words({name: table.pop(name) for name in list(table) if name in RunWords.model_fields}, where)
    shard = (1, 1) if options.shard is None else parse_shard(options.shard)
    if words.trials_file is None:
        return Asked(words, make_plan(settings_from(table, where)), None, shard)
    for name in BY_THE_SET:
        if name in table:
            raise InvalidInputError(f"{name} and a trials file exclude each other; the file says which trials.")
    text = read_trial_set(Path(words.trials_file))
    starts = starts_of(text, words.trials_file)
    table |= {
        "robots": list(dict.fromkeys(robot for robot, _, _ in starts)),
        "tasks": list(dict.fromkeys(task for _, task, _ in starts)),
        "objects": list(dict.fromkeys(name for _, _, name in starts)),
        "trials": max(map(len, starts.values())),
        "trials_sha256": sha256_of(text),
    }
    return Asked(words, make_plan(settings_from(table, where), starts), text, shard)


def _run_words(table: dict[str, Any], where: str) -> RunWords:
    if "out" not in table:
        raise InvalidInputError("out is missing; say in which folder the rows are kept, such as --out runs/table1")
    try:
        return RunWords.model_validate(table)
    except ValidationError as error:
        raise InvalidInputError(explain(error, where)) from None
