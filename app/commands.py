"""Commands: everything a person may ask of the running simulation, validated where it enters."""

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, ValidationError

from backend.config import Config, explain
from backend.errors import InvalidInputError
from backend.events import WorldEvent

SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Offered simulated seconds per second; besides them there is None, as fast as it goes."""

Seed = Annotated[int, Field(ge=0, le=2**31 - 1)]
OverrideValue = bool | int | float | str


class SetPaused(Config):
    """Stop asking the episode for snapshots, or go on."""

    kind: Literal["set_paused"] = "set_paused"
    paused: bool


class StepOnce(Config):
    """Pause, and advance by exactly one tick."""

    kind: Literal["step_once"] = "step_once"


class SetSpeed(Config):
    """Change the pace."""

    kind: Literal["set_speed"] = "set_speed"
    speed: Annotated[float, Field(ge=SPEEDS[0], le=SPEEDS[-1])] | None
    """Simulated seconds per second; None is as fast as the machine can."""


class Restart(Config):
    """Throw the episode away and start another."""

    kind: Literal["restart"] = "restart"
    scenario: Annotated[str, Field(min_length=1, max_length=100)]
    seed: Seed = 0
    overrides: Annotated[dict[str, OverrideValue], Field(max_length=50, default_factory=dict)]
    """Scenario values changed by their path, such as ``task.speed_mps``."""


class ApplyEvent(Config):
    """Edit the running world; the edit is written into the trial's record."""

    kind: Literal["apply_event"] = "apply_event"
    event: WorldEvent


Command = Annotated[
    SetPaused | StepOnce | SetSpeed | Restart | ApplyEvent,
    Field(discriminator="kind"),
]

_COMMANDS: TypeAdapter[Command] = TypeAdapter(Command)


def read_command(json_text: bytes | str) -> Command:
    """The command written in ``json_text``; raises ``InvalidInputError`` naming the key and its bound."""
    try:
        return _COMMANDS.validate_json(json_text)
    except ValidationError as error:
        raise InvalidInputError(explain(error, "command")) from None
