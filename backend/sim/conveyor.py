"""The belt: runs a motion forwards, slower, faster or backwards, and never jumps."""

from backend.motions import Motion
from backend.pose import Array, Pose

RATE_SLOPE_PER_S = 2.0
"""How fast the live rate may change; at 5 cm/s this is 0.1 m/s^2, far below what friction holds."""


class Conveyor:
    """Belt time is the integral of the rate over simulated time; the tray is where the motion is at belt time."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self.belt_s = 0.0
        self.rate = 1.0
        self._wanted_rate = 1.0
        self.xyz_m = motion.xyz_at(0.0)
        """The middle of the tray's top face, in the world."""

    def request_rate(self, rate: float) -> None:
        """Run at ``rate`` times the motion's own speed from now on, reached by a ramp."""
        self._wanted_rate = rate

    def advance(self, dt_s: float) -> None:
        """Let ``dt_s`` of simulated time pass."""
        change = self._wanted_rate - self.rate
        slope = RATE_SLOPE_PER_S * dt_s
        self.rate += min(max(change, -slope), slope)
        self.belt_s = min(max(self.belt_s + self.rate * dt_s, 0.0), self._motion.duration_s)
        self.xyz_m = self._motion.xyz_at(self.belt_s)

    @property
    def pose(self) -> Pose:
        """T_world_tray: the middle of the tray's top face."""
        return self._motion.pose_at(self.belt_s)

    @property
    def at_end(self) -> bool:
        """Whether the belt has come to the end it runs towards."""
        forward_end = self.rate >= 0.0 and self.belt_s >= self._motion.duration_s
        return forward_end or (self.rate < 0.0 and self.belt_s <= 0.0)

    def pose_in(self, ahead_s: float) -> Pose:
        """T_world_tray ``ahead_s`` from now if the rate stays as it is."""
        belt_s = self.belt_s + self.rate * ahead_s
        return self._motion.pose_at(min(max(belt_s, 0.0), self._motion.duration_s))

    def velocity_mps(self) -> Array:
        """(3,) velocity of the tray."""
        return self._motion.velocity_at(self.belt_s) * self.rate
