"""Linear motion with a change of height on the way."""

from typing import ClassVar, Literal, Self

from pydantic import model_validator

from backend.motions import LinearMotion
from backend.tasks.belt import BeltTask, DrawnBelt, Height, Speed, between
from backend.tasks.setup import TRAY_THICKNESS_M


class LinearZ(BeltTask):
    """Linear, with start and end at random heights; the tray stays level.

    Heights are those of the tray's middle, so 0.01 m is a tray on the floor. ``length_m`` is the level
    length, ``speed_mps`` the true speed along the slanted line.
    """

    title: ClassVar[str] = "Linear with Z motion"
    kind: Literal["linear_z"] = "linear_z"
    speed_mps: Speed
    height_min_m: Height = 0.01
    height_max_m: Height = 0.4
    start_height_m: Height | None = None
    """This height instead of a drawn one."""
    end_height_m: Height | None = None
    """This height instead of a drawn one."""

    @model_validator(mode="after")
    def _heights_are_ordered(self) -> Self:
        if self.height_min_m > self.height_max_m:
            raise ValueError("height_min_m must not exceed height_max_m")
        return self

    def motion(self, belt: DrawnBelt) -> LinearMotion:
        low, high, half = self.height_min_m, self.height_max_m, TRAY_THICKNESS_M / 2
        start, end = belt.ends(
            start_top_m=half + between(low, high, belt.start_height_share, self.start_height_m),
            end_top_m=half + between(low, high, belt.end_height_share, self.end_height_m),
        )
        return LinearMotion(start_m=start, end_m=end, start_speed_mps=self.speed_mps, end_speed_mps=self.speed_mps)
