"""Commands: everything a person may ask of the running simulation, validated where it enters."""

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, ValidationError, field_validator

from backend.config import Config, explain
from backend.errors import InvalidInputError
from backend.events import TimedEvent, WorldEvent

SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Offered simulated seconds per second; besides them there is None, as fast as it goes."""

Seed = Annotated[int, Field(ge=0, le=2**31 - 1)]
OverrideValue = bool | int | float | str
LARGEST_FILE_CHARS = 65_536
MOST_EVENTS = 1_000


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
    """A scenario's name; with ``file``, only what it is called."""
    seed: Seed = 0
    overrides: Annotated[dict[str, OverrideValue], Field(max_length=50, default_factory=dict)]
    """Scenario values changed by their path, such as ``task.speed_mps``."""
    file: Annotated[str, Field(max_length=LARGEST_FILE_CHARS)] | None = None
    """Text of a scenario file that somebody brought, instead of one of the project's."""
    events: Annotated[tuple[TimedEvent, ...], Field(max_length=MOST_EVENTS)] = ()
    """Live edits, repeated at their ticks."""
    from_tick: Annotated[int, Field(ge=0, le=240 * 3600)] = 0
    """Go through the ticks before this one unseen and as fast as it goes."""
    compare: Annotated[str, Field(min_length=1, max_length=100)] | None = None
    """A method that runs the same trial beside it, in step."""

    @field_validator("events", mode="before")
    @classmethod
    def _list_is_fine(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value


class ApplyEvent(Config):
    """Edit the running world; the edit is written into the trial's record."""

    kind: Literal["apply_event"] = "apply_event"
    event: WorldEvent


class LookBack(Config):
    """Pause, and show an earlier moment of the running trial."""

    kind: Literal["look_back"] = "look_back"
    t_s: Annotated[float, Field(ge=0.0, le=3600.0)] | None
    """Simulated time, of the last minute; None is the newest."""


class GoOn(Config):
    """Go on from the moment looked back at, as if what came after had not been."""

    kind: Literal["go_on"] = "go_on"


Command = Annotated[
    SetPaused | StepOnce | SetSpeed | Restart | ApplyEvent | LookBack | GoOn,
    Field(discriminator="kind"),
]

_COMMANDS: TypeAdapter[Command] = TypeAdapter(Command)


def read_command(json_text: bytes | str) -> Command:
    """The command written in ``json_text``; raises ``InvalidInputError`` naming the key and its bound."""
    try:
        return _COMMANDS.validate_json(json_text)
    except ValidationError as error:
        raise InvalidInputError(explain(error, "command")) from None
