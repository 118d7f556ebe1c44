"""The narrow door between the dashboard and the engine: what can be run, and running it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from app.commands import Restart
from backend.events import WorldEvent
from backend.pose import Array
from backend.snapshot import SceneDescription, Snapshot


@dataclass(frozen=True)
class TrialInfo:
    """What a ``Restart`` would run, in names and figures for people."""

    scenario: str
    title: str
    robot: str
    object: str
    task: str
    method: str
    speed_path: str | None
    """Path of the scenario value that sets the belt's speed; None where the task has no single one."""
    speed_mps: float | None
    """Belt speed at a live factor of 1; None where the task has no single one."""


class Running(Protocol):
    """An episode, as far as the worker needs it."""

    @property
    def scene(self) -> SceneDescription: ...

    def run(self) -> Iterator[Snapshot]: ...

    def apply(self, event: WorldEvent) -> None: ...

    def close(self) -> None: ...


class Engine(Protocol):
    """Stateless and picklable: the server asks what exists, the worker makes episodes."""

    def scenario_names(self) -> tuple[str, ...]: ...

    def object_names(self) -> tuple[str, ...]: ...

    def method_names(self) -> tuple[str, ...]: ...

    def describe(self, restart: Restart) -> TrialInfo:
        """Raises ``GraspingError`` when it cannot be run, saying why."""
        ...

    def make_episode(self, restart: Restart) -> Running: ...

    def tcp_trace(self, robot: str, waypoints: Array) -> Array:
        """(m, 3) way of the tcp in the world along joint ``waypoints`` (n, dof)."""
        ...
