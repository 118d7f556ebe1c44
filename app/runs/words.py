"""What a browser may say to begin a grid; the grid's own model checks it."""

from __future__ import annotations

import os
from typing import Annotated, Any

from pydantic import Field

from app.runs.shelf import NAME
from backend.errors import InvalidInputError
from backend.experiments.grid.cells import Plan, make_plan
from backend.experiments.grid.settings import GridSettings
from backend.experiments.grid.store import Facts
from backend.scenario.toml import to_toml_text

MOST_WORKERS = 256
MOST_CONDITIONS = 50
MOST_TRIALS = 10_000
"""Of each cell and object; more are for the command line."""
Workers = Annotated[int, Field(ge=1, le=MOST_WORKERS)]
Condition = Annotated[str, Field(max_length=200)]


class NewRun(GridSettings):
    """A grid to begin, or to go on with where its folder has rows of the same settings."""

    name: Annotated[str, Field(pattern=NAME)]
    """Its folder among the runs."""
    trials: Annotated[int, Field(ge=1, le=MOST_TRIALS)] = 100
    """Of each robot, task, object and method."""
    workers: Workers | None = None
    """Processes side by side; none: one per core."""
    set: Annotated[tuple[Condition, ...], Field(max_length=MOST_CONDITIONS)] = ()
    """``path=value`` for every scenario, such as ``sensing.dropout=0.1``."""

    def plan(self) -> Plan:
        """All trials; raises ``GraspingError``."""
        if self.trials_sha256 is not None:
            raise InvalidInputError("trials_sha256: trial sets are run from the command line: grid --trials-file.")
        return make_plan(GridSettings.model_validate(self.model_dump(exclude={"name", "workers"})))


def grid_file(facts: Facts) -> str:
    """Text of the grid file that goes on with a store."""
    table = {name: value for name, value in facts.decided.items() if name not in ("conditions", "trials_sha256")}
    if facts.trial_set is not None:
        for name in ("robots", "tasks", "objects", "trials", "first_seed"):
            table.pop(name, None)
    return _toml({**table, "judge": facts.judge})


def grid_file_of(plan: Plan) -> str:
    """Text of the grid file that begins a plan."""
    return _toml(plan.settings.model_dump(mode="json", exclude={"trials_sha256"}))


def cores() -> int:
    """How many workers there are when nobody says."""
    return os.cpu_count() or 1


def _toml(table: dict[str, Any]) -> str:
    return to_toml_text({name: value for name, value in table.items() if value is not None})
