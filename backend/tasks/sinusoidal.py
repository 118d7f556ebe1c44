"""Sinusoidal motion: a swing superimposed on the linear belt."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from backend.motions import SinusoidalMotion
from backend.tasks.belt import BeltTask, DrawnBelt, Speed


class Sinusoidal(BeltTask):
    """Linear with a sinusoid of amplitude l/8 and period l/3 across it.

    ``speed_mps`` is the progress along the axis; the true speed is 1.0 to 2.6 times that.
    """

    title: ClassVar[str] = "Sinusoidal"
    kind: Literal["sinusoidal"] = "sinusoidal"
    speed_mps: Speed
    amplitude_ratio: Annotated[float, Field(ge=0.0, le=0.5)] = 1 / 8
    """Amplitude as a share of ``length_m``."""
    period_ratio: Annotated[float, Field(ge=0.05, le=10.0)] = 1 / 3
    """Period as a share of ``length_m``."""

    def motion(self, belt: DrawnBelt) -> SinusoidalMotion:
        start, end = belt.ends()
        return SinusoidalMotion(
            start_m=start,
            end_m=end,
            speed_mps=self.speed_mps,
            amplitude_m=self.amplitude_ratio * belt.length_m,
            period_m=self.period_ratio * belt.length_m,
        )
