"""RayExecutor: actors on the nodes of a Ray cluster; a lost node, a dead or a stuck actor costs the trial it had."""

from __future__ import annotations

import os
import socket
import time
from dataclasses import dataclass
from typing import Any

from backend.errors import InvalidInputError, MissingResourceError
from backend.experiments.executors.executor import Done, Failure, Work
from backend.experiments.grid.cells import Job
from backend.experiments.grid.row import GridRow

ANSWER_S = 10.0
"""How long an address has to answer."""
THREADS = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")}
HERE = (None, "auto", "local")
"""Addresses that name no port of another machine."""


@dataclass(eq=False)
class UnderWay:
    """What an actor is doing: coming up (no job), or a job since a moment."""

    actor: Any
    job: Job | None
    begun_s: float


class Worker:
    """What lives on a node: loaded once, it keeps robots, grasps and fields for all its trials."""

    def __init__(self, work: Work, settings: str) -> None:
        self._work = work
        self._settings = settings

    def ready(self) -> None:
        """Answered when the process is up."""

    def run(self, job: Job) -> GridRow:
        return self._work(job, self._settings)


class RayExecutor:
    """``work`` of every job and the settings' hash, in ``workers`` actors (None: one per CPU of the cluster)."""

    def __init__(self, work: Work, settings: str, workers: int | None, limit_s: float, address: str | None) -> None:
        """Join the cluster at ``address``, or start one here (None).

        Raises ``MissingResourceError`` without Ray, ``InvalidInputError`` when the address does not answer.
        """
        self._ray = _joined(address, workers)
        self._limit_s = limit_s
        self._make: Any = self._ray.remote(num_cpus=1, max_restarts=0)(Worker)
        self._arguments = (work, settings)
        self.capacity = workers or max(1, int(self._ray.cluster_resources().get("CPU", 1)))
        self._idle: list[Any] = []
        self._waiting: list[Job] = []
        self._under_way: dict[Any, UnderWay] = {}
        for _ in range(self.capacity):
            self._add_worker()

    def submit(self, job: Job) -> None:
        """Hand a job over."""
        self._waiting.append(job)
        self._hand_out()

    def collect(self, timeout_s: float) -> list[Done]:
        """What has been done since the last call; waits at most so long for the first."""
        finished, _ = self._ray.wait(list(self._under_way), timeout=timeout_s)
        done = [outcome for reference in finished if (outcome := self._finish(reference)) is not None]
        done += self._stuck()
        self._hand_out()
        return done

    def drop_waiting(self) -> int:
        """Forget the jobs that no actor has begun; how many they were."""
        dropped, self._waiting = len(self._waiting), []
        return dropped

    def close(self) -> None:
        """End the actors, and the cluster if it was started here."""
        self._ray.shutdown()

    def _add_worker(self) -> None:
        actor = self._make.remote(*self._arguments)
        self._under_way[actor.ready.remote()] = UnderWay(actor, None, time.monotonic())

    def _hand_out(self) -> None:
        while self._idle and self._waiting:
            actor, job = self._idle.pop(), self._waiting.pop(0)
            self._under_way[actor.run.remote(job)] = UnderWay(actor, job, time.monotonic())

    def _finish(self, reference: Any) -> Done | None:
        """What a reference came to; None of an actor that has come up, or has not and is replaced."""
        own = self._under_way.pop(reference)
        try:
            row = self._ray.get(reference)
        except self._ray.exceptions.RayActorError as error:
            self._add_worker()
            why = str(error).strip().splitlines()[0]
            return None if own.job is None else (own.job, Failure(f"its actor died ({why})"))
        except self._ray.exceptions.RayTaskError as error:
            self._idle.append(own.actor)
            cause = error.cause or error
            return None if own.job is None else (own.job, Failure(f"{type(cause).__name__}: {cause}"))
        self._idle.append(own.actor)
        return None if own.job is None else (own.job, row)

    def _stuck(self) -> list[Done]:
        """Actors that have been at one job for too long are ended and replaced."""
        now_s = time.monotonic()
        late = [r for r, own in self._under_way.items() if own.job and now_s - own.begun_s > self._limit_s]
        done: list[Done] = []
        for reference in late:
            own = self._under_way.pop(reference)
            self._ray.kill(own.actor)
            self._add_worker()
            assert own.job is not None
            done.append((own.job, Failure(f"it took longer than {self._limit_s:g} s")))
        return done


def _joined(address: str | None, workers: int | None) -> Any:
    """The package, connected."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
    except ImportError:
        raise MissingResourceError("--executor ray needs Ray: pip install -c constraints.txt -e '.[cluster]'") from None
    if address not in HERE:
        _check_answers(address)
    package: Any = ray
    cpus = {"num_cpus": workers, "include_dashboard": False} if address in (None, "local") else {}
    try:
        package.init(address=address, log_to_driver=False, runtime_env={"env_vars": THREADS}, **cpus)
    except (ConnectionError, TimeoutError, RuntimeError) as error:
        raise InvalidInputError(f"No Ray cluster can be joined at {address or 'this machine'}: {error}") from None
    return package


def _check_answers(address: str) -> None:
    """Raise ``InvalidInputError`` unless somebody listens at ``host:port`` or ``ray://host:port``."""
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if not colon or not port.isdecimal():
        raise InvalidInputError(f"--ray-address is host:port, ray://host:port or auto (got {address!r})")
    try:
        socket.create_connection((host, int(port)), timeout=ANSWER_S).close()
    except (OSError, OverflowError) as error:
        raise InvalidInputError(f"No Ray cluster answers at {address}: {error}.") from None
