"""Again: the command that runs a row's trial once more on the page, and whether it came out the same."""

from __future__ import annotations

from typing import Literal

from app.commands import Restart
from app.permalink import address_of
from app.state import SessionState
from backend.errors import GraspingError, InvalidInputError
from backend.experiments.grid.cells import Job, Plan, scenario_name_of
from backend.experiments.grid.row import GridRow
from backend.scenario import to_toml

LARGEST_SEED = 2**31 - 1
Replay = Literal["elsewhere", "running", "same", "different"]


def restart_of(plan: Plan, row: GridRow) -> Restart:
    """Leads to exactly the trial of the row.

    Raises ``InvalidInputError`` for one that the page cannot begin, saying what can.
    """
    job = plan.job(row.key)
    if job.seed > LARGEST_SEED:
        raise InvalidInputError(f"The page has seeds up to {LARGEST_SEED}. {_headless(job)}")
    name = scenario_name_of(row.robot, row.task)
    if job.scenario.start is not None:
        return Restart(scenario=name, seed=job.seed, file=to_toml(job.scenario), overrides={})
    settings = plan.settings
    fields = dict(_parted(override) for override in settings.set)
    decided = {"object": row.object, "method": row.method, "profile": settings.profile}
    return Restart(
        scenario=name,
        seed=job.seed,
        overrides={**decided, "timing.think": settings.think, **fields},
    )


def link_to(plan: Plan, row: GridRow) -> str | None:
    """Address that opens the trial of the row; None where the page cannot begin it."""
    try:
        return address_of(restart_of(plan, row))
    except GraspingError:
        return None


def replay_of(restart: Restart, row: GridRow, state: SessionState) -> Replay:
    """How the page's trial compares with the row: ``elsewhere`` when it is another one."""
    if state.loading or state.repeated != restart:
        return "elsewhere"
    if state.keepsake is None:
        return "running"
    record = state.keepsake.record
    same = all(record.get(name) == getattr(row, name) for name in ("fingerprint", "strict", "authors", "reason"))
    return "same" if same else "different"


def _parted(override: str) -> tuple[str, str]:
    path, _, value = override.partition("=")
    return path.strip(), value.strip()


def _headless(job: Job) -> str:
    return f"Without a screen: python -m backend replay FOLDER {job.key}"
