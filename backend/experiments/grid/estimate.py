"""Estimate: what a grid would come to, said before anything starts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from backend.experiments.grid.cells import Plan
from backend.experiments.grid.duration import Duration, how_long
from backend.experiments.grid.folder import Shard, facts_of, store_file
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.store import check_same, read_store


@dataclass(frozen=True)
class Estimate:
    """How many trials, and about how long."""

    trials: int
    done: int
    duration: Duration
    """Of those that are not done."""


def estimate_of(plan: Plan, folder: Path, workers: int, shard: Shard = (1, 1)) -> Estimate:
    """The estimate of a grid in a folder that need not be there; nothing is written.

    Raises ``InvalidInputError`` when the folder has rows of other settings, naming them, or a corrupt store.
    """
    trials = plan.trials if shard[1] == 1 else sum(1 for _ in plan.jobs(lambda _: True, shard))
    path = store_file(folder, shard)
    rows: list[GridRow] = []
    if path.is_file() and path.stat().st_size > 0:
        with read_store(path) as store:
            check_same(path, store.facts, facts_of(plan, None))
            rows = list(store.rows())
    return Estimate(trials, len(rows), how_long(trials - len(rows), workers, rows))
