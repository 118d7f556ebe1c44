"""Linear motion under a slab that keeps the hand from coming straight down."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from backend.motions import LinearMotion
from backend.objects.description import ObjectDescription
from backend.pose import Pose
from backend.snapshot import BoxPlacement
from backend.tasks.belt import BeltTask, DrawnBelt, Speed
from backend.tasks.linear import straight
from backend.tasks.setup import TRAY_THICKNESS_M, TrialSetup


class LinearSlab(BeltTask):
    """Linear, with a fixed slab above the whole length of the belt."""

    title: ClassVar[str] = "Linear with top slab"
    kind: Literal["linear_slab"] = "linear_slab"
    speed_mps: Speed
    slab_height_m: Annotated[float, Field(ge=0.1, le=2.0)] = 0.40
    """From the tray's top face to the slab's underside."""
    slab_thickness_m: Annotated[float, Field(gt=0.0, le=0.5)] = 0.02
    slab_width_m: Annotated[float, Field(gt=0.0, le=1.0)] = 0.10

    def motion(self, belt: DrawnBelt) -> LinearMotion:
        return straight(belt, self.speed_mps)

    def laid(self, belt: DrawnBelt, target: ObjectDescription) -> TrialSetup:
        """The belt with its slab."""
        middle_m = TRAY_THICKNESS_M + self.slab_height_m + self.slab_thickness_m / 2
        T_world_box = belt.T_world_belt @ Pose.of((0.0, 0.0, middle_m))
        slab = BoxPlacement(T_world_box, (self.length_m, self.slab_width_m, self.slab_thickness_m))
        return replace(super().laid(belt, target), slab=slab)
