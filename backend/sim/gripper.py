"""The hand's drive: what its master joint is asked to do, ramped at the hand's own speed."""

from backend.robots.description import GripperDescription


class GripperDrive:
    """Ramps the master's target towards open or closed."""

    def __init__(self, gripper: GripperDescription) -> None:
        self._gripper = gripper
        self._goal_rad = gripper.open_rad
        self.target_rad = gripper.open_rad
        """What the master is asked for now."""

    def open(self) -> None:
        """Open from the next update on."""
        self._goal_rad = self._gripper.open_rad

    def close(self) -> None:
        """Close from the next update on; the motor's force limit decides how hard."""
        self._goal_rad = self._gripper.closed_rad

    def go_on_from(self, rad: float) -> None:
        """Ramp on as if the target were ``rad`` now."""
        self.target_rad = rad

    def update(self, dt_s: float) -> float:
        """The master's target, rad, after ``dt_s`` more."""
        most = self._gripper.close_speed_rps * dt_s
        self.target_rad += min(max(self._goal_rad - self.target_rad, -most), most)
        return self.target_rad
