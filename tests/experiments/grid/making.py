"""Small grids and rows for tests, made without a simulation."""

from dataclasses import replace
from pathlib import Path

from backend.experiments.grid.cells import Job, Key, Plan, make_plan
from backend.experiments.grid.folder import facts_of
from backend.experiments.grid.row import GridRow, error_row
from backend.experiments.grid.settings import GridSettings
from backend.experiments.grid.store import Store, open_store

METHODS = ("ik", "baseline")
SMALL = GridSettings(
    robots=("ur5_robotiq",), tasks=("linear",), objects=("cube",), methods=("ik", "baseline"), trials=4
)


def plan(**changes: object) -> Plan:
    return make_plan(SMALL.model_copy(update=changes))


def all_jobs(of: Plan) -> list[Job]:
    return list(of.jobs(lambda _: True))


def row_of(job: Job, settings: str = "none") -> GridRow:
    """As if the trial had been run: a success where index + method's length is even."""
    row = error_row(settings, job, "", "0+test", "this machine", "2026-01-01T00:00:00Z")
    strict = (job.key.index + len(job.key.method)) % 2 == 0
    reason = None if strict else "timeout"
    return replace(row, strict=strict, authors=strict, reason=reason, end_s=10.0, fingerprint=str(job.key), attempts=1)


def store_in(folder: Path, of: Plan | None = None, name: str = "grid.sqlite") -> Store:
    return open_store(folder / name, facts_of(of or plan(), None))


def key(index: int, method: str = "ik") -> Key:
    return Key("ur5_robotiq", "linear", "cube", method, index)
