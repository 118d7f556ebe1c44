"""Executor: the protocol between a grid and whatever runs its trials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from backend.experiments.grid.cells import Job
from backend.experiments.grid.row import GridRow


@dataclass(frozen=True)
class Failure:
    """A trial that did not come to an end: its worker crashed, hung or raised."""

    why: str


Work = Callable[[Job, str], GridRow]
"""What runs a job, given the settings' hash."""
Done = tuple[Job, GridRow | Failure]


class Executor(Protocol):
    """Runs jobs side by side. A job that fails is reported, and costs nothing but itself."""

    @property
    def capacity(self) -> int:
        """How many jobs to hand over so that no worker waits."""
        ...

    def submit(self, job: Job) -> None:
        """Hand a job over."""
        ...

    def collect(self, timeout_s: float) -> list[Done]:
        """What has been done since the last call; waits at most so long for the first."""
        ...

    def drop_waiting(self) -> int:
        """Forget the jobs that no worker has begun; how many they were."""
        ...

    def close(self) -> None:
        """End the workers, whatever they do."""
        ...
