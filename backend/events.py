"""Live edits of a running episode: recorded in the trial, so that an edited run can be repeated headless."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from backend.config import Config
from backend.errors import not_found_text
from backend.objects import object_names

MOST_OBSTACLES = 16
Level = Annotated[float, Field(ge=-2.0, le=2.0)]
Yaw = Annotated[float, Field(ge=-6.3, le=6.3)]
ObstacleIndex = Annotated[int, Field(ge=0, lt=MOST_OBSTACLES)]


class SetBeltRate(Config):
    """Scale the belt's speed from now on; the belt ramps to it."""

    kind: Literal["set_belt_rate"] = "set_belt_rate"
    rate: Annotated[float, Field(ge=-4.0, le=4.0)]
    """1 is the scenario's speed; 0 stops; negative runs backwards."""


class MoveObstacle(Config):
    """Put an obstacle elsewhere, upright on the floor."""

    kind: Literal["move_obstacle"] = "move_obstacle"
    index: ObstacleIndex
    x_m: Level
    y_m: Level
    yaw_rad: Yaw = 0.0


class AddObstacle(Config):
    """One more obstacle, upright on the floor; it is the last of them."""

    kind: Literal["add_obstacle"] = "add_obstacle"
    object: str
    """What stands there: any object that can be grasped."""
    x_m: Level
    y_m: Level
    yaw_rad: Yaw = 0.0

    @field_validator("object")
    @classmethod
    def _object_exists(cls, name: str) -> str:
        if name not in object_names():
            raise ValueError(not_found_text("object", name, object_names()))
        return name


class RemoveObstacle(Config):
    """Take an obstacle away; those after it move up by one."""

    kind: Literal["remove_obstacle"] = "remove_obstacle"
    index: ObstacleIndex


class SetSlab(Config):
    """Hold a slab above the belt, at another height, or take it away."""

    kind: Literal["set_slab"] = "set_slab"
    height_m: Annotated[float, Field(ge=0.1, le=2.0)] | None
    """From the tray's top face, where the belt is highest, to the slab's underside; none takes it away."""


WorldEvent = Annotated[SetBeltRate | MoveObstacle | AddObstacle | RemoveObstacle | SetSlab, Field(discriminator="kind")]


class TimedEvent(Config):
    """A world event and the tick before which it acts."""

    tick: Annotated[int, Field(ge=0)]
    event: WorldEvent
