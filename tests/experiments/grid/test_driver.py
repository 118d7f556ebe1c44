"""A run of a grid: whatever workers do, every trial gets one row, and a stop loses none."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from backend.experiments.executors.executor import Done, Work
from backend.experiments.executors.local import LocalExecutor
from backend.experiments.grid.cells import Job, Plan
from backend.experiments.grid.driver import Stop, drive
from backend.experiments.grid.folder import read_grid
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.store import Store
from tests.experiments.grid import faulty
from tests.experiments.grid.making import all_jobs, plan, row_of, store_in


def run_with(work: Work, store: Store, of: Plan, stop: Stop, tell: Callable[[GridRow], None], limit_s: float) -> bool:
    executor = LocalExecutor(work, store.facts.settings, 2, limit_s)
    done = store.keys()
    try:
        return drive(of.jobs(lambda key: key not in done), executor, store, stop, tell)
    finally:
        executor.close()


def test_a_crash_a_hang_and_an_error_cost_one_retry_and_one_row_each(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(faulty.ONCE_FILE, str(tmp_path / "once-"))
    of = plan(trials=7)
    with store_in(tmp_path, of) as store:
        assert run_with(faulty.work, store, of, Stop(), lambda _: None, limit_s=3.0)
        rows = {row.key: row for row in store.rows()}
        assert rows.keys() == {job.key for job in all_jobs(of)}
        words = {faulty.CRASHES: "SIGSEGV", faulty.HANGS: "longer than 3 s", faulty.RAISES: "a knot in the arm"}
        for key, row in rows.items():
            if key.index in words:
                assert row.reason == "error" and not row.strict and row.attempts == 2
                assert words[key.index] in row.detail and "both times" in row.detail
            else:
                assert row.reason != "error"
                assert row.attempts == (2 if key.index == faulty.ONLY_ONCE else 1)
                assert row.settings == store.facts.settings


def test_a_stop_finishes_what_is_under_way_and_the_next_run_goes_on(tmp_path: Path):
    of = plan(trials=20)
    stop = Stop()
    told: list[GridRow] = []

    def tell(row: GridRow) -> None:
        told.append(row)
        stop.wanted = len(told) >= 5

    with store_in(tmp_path, of) as store:
        assert not run_with(faulty.slow, store, of, stop, tell, limit_s=60.0)
        assert 5 <= len(told) < 12 and store.keys() == {row.key for row in told}
        assert run_with(faulty.slow, store, of, Stop(), told.append, limit_s=60.0)
        assert Counter(row.key for row in told) == Counter(job.key for job in all_jobs(of))


class AtOnce:
    """An executor that does everything at once, in this process; the listed jobs fail as often as is said."""

    def __init__(self, failures: dict[str, int]) -> None:
        self.capacity = 3
        self.most = 0
        self._failures = failures
        self._jobs: list[Job] = []

    def submit(self, job: Job) -> None:
        self._jobs.append(job)
        self.most = max(self.most, len(self._jobs))

    def collect(self, timeout_s: float) -> list[Done]:
        from backend.experiments.executors.executor import Failure

        job = self._jobs.pop(0)
        left = self._failures.get(str(job.key), 0)
        self._failures[str(job.key)] = left - 1
        return [(job, Failure(f"failure {left}") if left > 0 else row_of(job))]

    def drop_waiting(self) -> int:
        dropped, self._jobs = len(self._jobs), []
        return dropped

    def close(self) -> None:
        pass


def test_a_job_is_tried_twice_and_no_more(tmp_path: Path):
    of = plan(trials=5)
    keys = [str(job.key) for job in all_jobs(of)]
    executor = AtOnce({keys[0]: 1, keys[4]: 2, keys[9]: 5})
    with store_in(tmp_path, of) as store:
        assert drive(of.jobs(lambda _: True), executor, store, Stop(), lambda _: None)
        errors = {str(row.key): row.detail for row in store.rows() if row.reason == "error"}
        assert errors == {
            keys[4]: "Run twice: failure 2; then failure 1.",
            keys[9]: "Run twice: failure 5; then failure 4.",
        }
        assert len(store.keys()) == 10
    assert executor.most == executor.capacity


def test_no_error_is_written_once_a_stop_is_wanted(tmp_path: Path):
    of = plan(trials=5)
    stop = Stop()
    failing = {str(job.key): 9 for job in all_jobs(of)[1:]}

    def tell(_: GridRow) -> None:
        stop.wanted = True

    with store_in(tmp_path, of) as store:
        assert not drive(of.jobs(lambda _: True), AtOnce(failing), store, stop, tell)
        assert [row.reason for row in store.rows()] in ([None], ["timeout"])


SCRIPT = """
import sys, time
from pathlib import Path
from backend.experiments.grid.driver import Stop, drive
from tests.experiments.grid.making import plan, row_of, store_in
from tests.experiments.grid.test_driver import AtOnce
of = plan(trials=2000)
with store_in(Path(sys.argv[1]), of) as store:
    done = store.keys()
    print("begun", flush=True)
    drive(of.jobs(lambda key: key not in done), AtOnce({}), store, Stop(), lambda row: print(row.key, flush=True))
"""

WITH_WORKERS = SCRIPT.replace("AtOnce({})", "LocalExecutor(faulty.slow, 'x', 2, 60.0)").replace(
    "from tests.experiments.grid.test_driver import AtOnce",
    "from tests.experiments.grid import faulty\nfrom backend.experiments.executors.local import LocalExecutor",
)


def test_killed_at_any_moment_no_row_is_lost_or_doubled(tmp_path: Path):
    chance = np.random.default_rng(0)
    told: set[str] = set()
    for _ in range(4):
        with begun(SCRIPT, tmp_path) as (process, lines):
            killer = threading.Timer(float(chance.uniform(0.02, 0.4)), process.kill)
            killer.start()
            told |= {line.strip() for line in lines if line.endswith("\n")}
            assert process.wait(timeout=60) == -signal.SIGKILL
        with read_grid(tmp_path) as store:
            rows = [str(row.key) for row in store.rows()]
        assert len(rows) == len(set(rows)) and told <= set(rows)
    assert 0 < len(told) < 4000


def test_workers_do_not_outlive_a_killed_grid(tmp_path: Path):
    with begun(WITH_WORKERS, tmp_path) as (process, lines):
        for _ in range(4):
            assert next(lines)
        process.kill()
        process.wait(timeout=10)
        deadline_s = time.monotonic() + 20.0
        while group_lives(process.pid) and time.monotonic() < deadline_s:
            time.sleep(0.2)
        assert not group_lives(process.pid)


@contextmanager
def begun(script: str, folder: Path) -> Generator[tuple[subprocess.Popen[str], Iterator[str]]]:
    """A process of its own group that has said that it begins, and the lines it says from then on."""
    command = [sys.executable, "-c", script, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        yield process, process.stdout


def group_lives(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
