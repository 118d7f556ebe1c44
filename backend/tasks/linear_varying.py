"""Linear motion with evenly changing speed."""

from typing import ClassVar, Literal

from backend.motions import LinearMotion
from backend.tasks.belt import BeltTask, DrawnBelt, Speed


class LinearVarying(BeltTask):
    """Linear, accelerated evenly from the start's speed to the end's over the whole belt."""

    title: ClassVar[str] = "Linear with varying speed"
    kind: Literal["linear_varying"] = "linear_varying"
    start_speed_mps: Speed
    end_speed_mps: Speed

    def motion(self, belt: DrawnBelt) -> LinearMotion:
        start, end = belt.ends()
        return LinearMotion(
            start_m=start, end_m=end, start_speed_mps=self.start_speed_mps, end_speed_mps=self.end_speed_mps
        )
