"""Circular motion around the robot."""

from typing import ClassVar, Literal

from backend.motions import CircularMotion
from backend.tasks.belt import BeltTask, DrawnBelt, Speed
from backend.tasks.setup import TRAY_THICKNESS_M


class Circular(BeltTask):
    """An arc of ``length_m`` around the base; theta is where it starts and the distance is its radius."""

    title: ClassVar[str] = "Circular"
    kind: Literal["circular"] = "circular"
    speed_mps: Speed

    def motion(self, belt: DrawnBelt) -> CircularMotion:
        return CircularMotion(
            center_m=(0.0, 0.0, TRAY_THICKNESS_M),
            radius_m=belt.distance_m,
            start_angle_rad=belt.theta_rad,
            direction=belt.direction,
            length_m=belt.length_m,
            speed_mps=self.speed_mps,
        )
