"""Scenario: one reproducible problem, as a scenario file says it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from backend.config import Config, Probability
from backend.errors import NotFoundError, lookup
from backend.events import TimedEvent
from backend.methods import METHODS, Method
from backend.objects import object_names
from backend.robots.description import ProfileName
from backend.tasks import Task
from backend.tasks.start import Start, read_start

T = TypeVar("T")
Table = dict[str, Any]


class SensingConfig(Config):
    """How the robot sees the object."""

    rate_hz: Annotated[float, Field(gt=0.0, le=240.0)] = 20.0
    position_noise_std_m: Annotated[float, Field(ge=0.0, le=0.1)] = 0.0
    """Standard deviation on each axis."""
    yaw_noise_std_rad: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    latency_s: Annotated[float, Field(ge=0.0, le=2.0)] = 0.0
    """From the moment an observation shows to the moment the robot has it."""
    dropout: Probability = 0.0
    """Probability that a detection is lost."""


class TimingConfig(Config):
    """What thinking costs in simulated time, and when a trial is given up."""

    think: Literal["budget", "paper", "measured"] = "budget"
    """A fixed time, the constants of the paper's evaluation, or the wall time of each cycle."""
    budget_s: Annotated[float, Field(gt=0.0, le=10.0)] = 0.05
    timeout_s: Annotated[float, Field(gt=0.0, le=3600.0)] = 120.0


class Scenario(Config):
    """Robot, object, task, method and conditions; with a seed, it decides a whole trial."""

    title: Annotated[str, Field(min_length=1, max_length=120)]
    description: str | None = None
    robot: str
    object: str
    task: Task
    method: Method
    """A name, or a table with a name and what differs from the method of that name."""
    sensing: SensingConfig = SensingConfig()
    timing: TimingConfig = TimingConfig()
    profile: ProfileName = "paper"
    """Joint speeds: those of the paper's evaluation, or of the data sheet."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """Of the trial when none is asked for."""
    events: tuple[TimedEvent, ...] = ()
    """Live edits, repeated at their ticks."""
    start: Start | None = None
    """Where object, belt, slab and obstacles are, as in a row of a trial set; without it the seed draws them."""

    @field_validator("robot")
    @classmethod
    def _robot_exists(cls, name: str) -> str:
        from backend.robots import ROBOTS

        known("robot", name, ROBOTS)
        return name

    @field_validator("object")
    @classmethod
    def _object_exists(cls, name: str) -> str:
        known("object", name, dict.fromkeys(object_names()))
        return name

    @field_validator("method", mode="before")
    @classmethod
    def _method_by_name(cls, value: object) -> object:
        if isinstance(value, str):
            return known("method", value, METHODS)
        return method_table(value) if isinstance(value, dict) else value

    @field_validator("start")
    @classmethod
    def _start_fits(cls, value: Start | None, so_far: ValidationInfo) -> Start | None:
        task: Task | None = so_far.data.get("task")
        if value is None or task is None:
            return value
        start, wrong = read_start(task.kind, value)
        if wrong:
            text = "; ".join(f"{column}: {complaint}" for column, complaint in wrong)
            raise PydanticCustomError("start", "{text}", {"text": text})
        return start

    @field_validator("events", mode="before")
    @classmethod
    def _list_is_fine(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value


def known(kind: str, name: str, table: Mapping[str, T]) -> T:
    """``table[name]``, or a complaint that names what exists, in pydantic's terms."""
    try:
        return lookup(kind, name, table)
    except NotFoundError as error:
        raise PydanticCustomError("unknown_name", "{text}", {"text": str(error)}) from None


def method_table(changes: Table) -> Table:
    """The whole table of the method that ``changes["name"]`` names, with the changes made."""
    name = changes.get("name")
    if not isinstance(name, str):
        available = ", ".join(sorted(METHODS))
        raise PydanticCustomError(
            "method_name", "a method table needs a name. Available: {names}", {"names": available}
        )
    return changed(known("method", name, METHODS).model_dump(), changes)


def changed(base: Table, changes: Table) -> Table:
    """``base`` with ``changes`` made at every depth; a table of another kind replaces the old one whole."""
    out = dict(base)
    for key, value in changes.items():
        before = base.get(key)
        if isinstance(value, dict) and isinstance(before, dict):
            same_kind = value.get("kind", before.get("kind")) == before.get("kind")
            out[key] = changed(before if same_kind else {}, value)
        else:
            out[key] = value
    return out


def differences(base: Table, table: Table) -> Table:
    """The smallest ``changes`` with ``changed(base, changes) == table``; both have the same keys per kind."""
    out: Table = {}
    for key, value in table.items():
        before = base.get(key)
        if value == before:
            continue
        if isinstance(value, dict) and isinstance(before, dict) and value.get("kind") == before.get("kind"):
            out[key] = differences(before, value)
        else:
            out[key] = value
    return out
