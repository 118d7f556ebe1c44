"""Linear motion: the object moves straight, on the floor, at constant speed."""

from typing import ClassVar, Literal

from backend.motions import LinearMotion
from backend.tasks.belt import BeltTask, DrawnBelt, Speed


class Linear(BeltTask):
    """The plain belt."""

    title: ClassVar[str] = "Linear"
    kind: Literal["linear"] = "linear"
    speed_mps: Speed

    def motion(self, belt: DrawnBelt) -> LinearMotion:
        return straight(belt, self.speed_mps)


def straight(belt: DrawnBelt, speed_mps: float) -> LinearMotion:
    """The floor-level motion of a drawn belt at constant speed."""
    start, end = belt.ends()
    return LinearMotion(start_m=start, end_m=end, start_speed_mps=speed_mps, end_speed_mps=speed_mps)
