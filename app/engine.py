"""The narrow door between the dashboard and the engine: what can be run, and running it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from app.commands import Restart
from backend.events import WorldEvent
from backend.knowledge.reach_profile import ReachProfile
from backend.pose import Array
from backend.scenario import Scenario
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
    values: Scenario
    """Everything that is set, edits included."""


def info_of(name: str, values: Scenario) -> TrialInfo:
    """What a scenario, called ``name``, would run."""
    speed_mps: float | None = getattr(values.task, "speed_mps", None)
    return TrialInfo(
        scenario=name,
        title=values.title,
        robot=values.robot,
        object=values.object,
        task=values.task.kind,
        method=values.method.name,
        speed_path=None if speed_mps is None else "task.speed_mps",
        speed_mps=speed_mps,
        values=values,
    )


@dataclass(frozen=True, eq=False)
class Keepsake:
    """What is left of a trial that has ended, for download."""

    record: dict[str, object]
    """Its row."""
    trace: bytes
    """A file for ``python -m backend replay``."""


class Running(Protocol):
    """An episode, as far as the worker needs it."""

    @property
    def scene(self) -> SceneDescription: ...

    def run(self) -> Iterator[Snapshot]: ...

    def check(self, event: WorldEvent) -> None:
        """Raises ``GraspingError`` for an edit that ``apply`` would refuse now."""
        ...

    def apply(self, event: WorldEvent) -> None: ...

    def edited(self, snapshot: Snapshot) -> Snapshot:
        """The newest snapshot with what edits have changed since."""
        ...

    def keepsake(self) -> Keepsake:
        """Only of an episode that has ended."""
        ...

    def close(self) -> None: ...


class Engine(Protocol):
    """Stateless and picklable: the server asks what exists, the worker makes episodes."""

    def scenario_names(self) -> tuple[str, ...]: ...

    def object_names(self) -> tuple[str, ...]: ...

    def method_names(self) -> tuple[str, ...]: ...

    def describe(self, restart: Restart) -> TrialInfo:
        """Raises ``GraspingError`` when it cannot be run, saying why."""
        ...

    def seed_in(self, name: str, text: str) -> int:
        """The seed of a scenario file with this text; raises ``InvalidInputError`` with every mistake in it."""
        ...

    def make_episode(self, restart: Restart) -> Running: ...

    def reach(self, robot: str) -> ReachProfile:
        """How far that robot reaches, for drawing."""
        ...

    def tcp_trace(self, robot: str, waypoints: Array) -> Array:
        """(m, 3) way of the tcp in the world along joint ``waypoints`` (n, dof)."""
        ...
