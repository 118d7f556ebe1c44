"""Driver: hands the trials that have no row yet to an executor and writes each row when it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from backend.experiments.executors.executor import Executor, Failure
from backend.experiments.grid.cells import Job, Key
from backend.experiments.grid.code import code_version
from backend.experiments.grid.row import GridRow, error_row
from backend.experiments.grid.store import Store
from backend.experiments.grid.work import now
from backend.machine import machine

LISTEN_S = 0.5


@dataclass
class Stop:
    """Whether running trials are the last ones."""

    wanted: bool = False


def drive(jobs: Iterator[Job], executor: Executor, store: Store, stop: Stop, tell: Callable[[GridRow], None]) -> bool:
    """Run the jobs, write every row, then show it to ``tell``; whether all were run.

    A job that fails is run once more; if it fails again, its row says ``error``. Once a stop is wanted, trials under
    way are finished and written, and no failure is: it may be the stop's own doing. Raises ``StorageError``.
    """
    failed: dict[Key, str] = {}
    under_way = 0
    exhausted = cut_short = False
    while True:
        while not exhausted and not stop.wanted and under_way < executor.capacity:
            job = next(jobs, None)
            if job is None:
                exhausted = True
            else:
                executor.submit(job)
                under_way += 1
        if stop.wanted and not cut_short:
            under_way -= executor.drop_waiting()
            cut_short = True
        if under_way == 0:
            return exhausted and not cut_short
        for job, outcome in executor.collect(LISTEN_S):
            under_way -= 1
            if isinstance(outcome, GridRow):
                _write(replace(outcome, attempts=1 + (job.key in failed)), store, tell)
            elif stop.wanted:
                continue
            elif job.key in failed:
                _write(_error(job, failed.pop(job.key), outcome, store), store, tell)
            else:
                failed[job.key] = outcome.why
                executor.submit(job)
                under_way += 1


def _write(row: GridRow, store: Store, tell: Callable[[GridRow], None]) -> None:
    store.add(row)
    tell(row)


def _error(job: Job, first: str, second: Failure, store: Store) -> GridRow:
    why = f"Run twice: {first}; then {second.why}." if first != second.why else f"Run twice: {first} both times."
    return error_row(store.facts.settings, job, why, code_version(), machine(), now())
