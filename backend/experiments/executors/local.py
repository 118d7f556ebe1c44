"""LocalExecutor: spawned processes of this machine that stay warm, one thread each; a dead or stuck one is replaced."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
from concurrent.futures import CancelledError, Future, wait

from pebble import ProcessExpired, ProcessPool

from backend.errors import GraspingError
from backend.experiments.executors.executor import Done, Failure, Work
from backend.experiments.grid.cells import Job
from backend.experiments.grid.row import GridRow

BREAKS_AT_MOST = 10
JOBS_PER_WORKER = 2
"""One under way and one ready."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
OBJECTS_BETWEEN_SWEEPS = 100_000
"""Loaded knowledge is many objects that stay; Python's 700 would sweep them again and again."""


class LocalExecutor:
    """``work`` of every job and the settings' hash, in ``workers`` processes; a job may take ``limit_s``."""

    def __init__(self, work: Work, settings: str, workers: int, limit_s: float) -> None:
        for name in THREADS:
            os.environ.setdefault(name, "1")
        self.capacity = JOBS_PER_WORKER * workers
        self._work = work
        self._settings = settings
        self._limit_s = limit_s
        self._workers = workers
        self._pool = self._new_pool()
        self._breaks = 0
        self._under_way: dict[Future[GridRow], Job] = {}

    def submit(self, job: Job) -> None:
        """Hand a job over; raises ``GraspingError`` when workers keep dying before they begin."""
        if not self._pool.active:
            self._replace_pool()
        future = self._pool.schedule(self._work, args=[job, self._settings], timeout=self._limit_s)
        self._under_way[future] = job

    def collect(self, timeout_s: float) -> list[Done]:
        """What has been done since the last call; waits at most so long for the first."""
        done = wait(self._under_way, timeout_s, return_when="FIRST_COMPLETED").done
        return [(self._under_way.pop(future), self._outcome(future)) for future in done]

    def drop_waiting(self) -> int:
        """Forget the jobs that no worker has begun; how many they were."""
        waiting = [future for future in self._under_way if not future.running() and future.cancel()]
        for future in waiting:
            del self._under_way[future]
        return len(waiting)

    def close(self) -> None:
        """End the workers, whatever they do."""
        self._pool.stop()
        self._pool.join()

    def _new_pool(self) -> ProcessPool:
        context = multiprocessing.get_context("spawn")
        return ProcessPool(self._workers, context=context, initializer=_prepare)

    def _replace_pool(self) -> None:
        """A worker that dies between two jobs breaks pebble's pool."""
        self._breaks += 1
        if self._breaks > BREAKS_AT_MOST:
            raise GraspingError("Workers die before they begin a trial: too little memory? Try fewer workers.")
        self.close()
        self._pool = self._new_pool()

    def _outcome(self, future: Future[GridRow]) -> GridRow | Failure:
        try:
            return future.result()
        except TimeoutError:
            return Failure(f"it took longer than {self._limit_s:g} s")
        except ProcessExpired as error:
            return Failure(f"its process died ({_death(error.exitcode)})")
        except CancelledError:
            return Failure("it was cancelled")
        except Exception as error:
            return Failure(f"{type(error).__name__}: {error}")


def _prepare() -> None:
    """Leave interrupts to the parent, which lets running trials finish."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.set_threshold(OBJECTS_BETWEEN_SWEEPS, 50, 50)


def _death(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return signal.Signals(-exitcode).name
    return f"exit code {exitcode}"
