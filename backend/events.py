"""Live edits of a running episode: recorded in the trial, so that an edited run can be repeated headless."""

from typing import Annotated, Literal

from pydantic import Field

from backend.config import Config


class SetBeltRate(Config):
    """Scale the belt's speed from now on; the belt ramps to it."""

    kind: Literal["set_belt_rate"] = "set_belt_rate"
    rate: Annotated[float, Field(ge=-4.0, le=4.0)]
    """1 is the scenario's speed; 0 stops; negative runs backwards."""


class MoveObstacle(Config):
    """Put an obstacle elsewhere, upright on the floor."""

    kind: Literal["move_obstacle"] = "move_obstacle"
    index: Annotated[int, Field(ge=0, le=15)]
    x_m: Annotated[float, Field(ge=-2.0, le=2.0)]
    y_m: Annotated[float, Field(ge=-2.0, le=2.0)]
    yaw_rad: Annotated[float, Field(ge=-6.3, le=6.3)] = 0.0


WorldEvent = Annotated[SetBeltRate | MoveObstacle, Field(discriminator="kind")]


class TimedEvent(Config):
    """A world event and the tick before which it acts."""

    tick: Annotated[int, Field(ge=0)]
    event: WorldEvent
