"""Execute: joint targets for every physics step, and the order of watch, move, approach, close, lift and hold."""

from backend.kinematics import Kinematics
from backend.methods.method import Execution
from backend.pipeline.execute.approach import Approach
from backend.pipeline.execute.cartesian import ArmState
from backend.pipeline.execute.closing import Closing
from backend.pipeline.execute.lift import plan_lift
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.values import Phase, Refusal
from backend.pose import Array
from backend.sim.bullet import STEP_S, GripperDrive
from backend.trajectory import Trajectory

LIFT_PARTS = (1.0, 0.8, 0.6)
"""Parts of the wanted height that are tried in turn when the arm cannot follow all of it."""


class Executor:
    """Holds the trajectory in force, the one that takes over next, and the phase."""

    def __init__(self, kinematics: Kinematics, limits: JointLimits, config: Execution, home: Array) -> None:
        self.phase: Phase = "watch"
        self.approach: Approach | None = None
        """The approach under way."""
        self.lift_refusal: str | None = None
        self._kinematics = kinematics
        self._limits = limits
        self._config = config
        self._current = Trajectory.hold(home, 0.0)
        self._next: Trajectory | None = None
        self._closing: Closing | None = None

    @property
    def in_force(self) -> Trajectory:
        """What the arm follows now."""
        return self._current

    def arm_at(self, t_s: float) -> ArmState:
        """Where the arm will be commanded to be at ``t_s``, as far as is decided now."""
        upcoming = self._next
        trajectory = upcoming if upcoming is not None and t_s >= upcoming.start_s else self._current
        return ArmState(*trajectory.sample(t_s), t_s)

    def move_along(self, trajectory: Trajectory) -> None:
        """Take over ``trajectory`` at its start."""
        self._next = trajectory
        if self.phase == "watch":
            self.phase = "move"

    def begin_approach(self, approach: Approach) -> None:
        """Go in; a later call while approaching corrects the way."""
        self._next = approach.trajectory
        self.approach = approach
        self.phase = "approach"

    def break_off(self, halt: Trajectory) -> None:
        """Come to rest instead of going in."""
        self._next = halt
        self.approach = None
        self.phase = "move"

    def targets(self, t_s: float) -> tuple[list[float], list[float]]:
        """(q, qd) for the physics step that begins at ``t_s``."""
        self.take_over(t_s)
        return self._current.sample_plain(t_s)

    def take_over(self, t_s: float) -> None:
        """Put the next trajectory in force if its time has come."""
        if self._next is not None and t_s >= self._next.start_s - 1e-9:
            self._current, self._next = self._next, None

    def advance(self, t_s: float, gripper: GripperDrive, finger_rad: float) -> None:
        """Go on to the next phase when its time has come; ``finger_rad`` is where the master joint really is."""
        if self.phase == "approach" and self.approach is not None and t_s >= self.approach.arrive_s:
            self.phase = "close"
            self._closing = Closing(t_s, self._config.close_s, finger_rad)
            gripper.close()
        elif self._closing is not None and self.phase == "close":
            closed = self._closing.over(t_s, STEP_S, finger_rad)
            if closed or t_s >= self._current.end_s - STEP_S:
                self._lift(t_s)
        elif self.phase == "lift" and t_s >= self._current.end_s and self._next is None:
            self.phase = "hold"
        elif self.phase == "hold" and t_s >= self._current.end_s + self._config.hold_s:
            self.phase = "done"

    def _lift(self, t_s: float) -> None:
        """Straight up as far as was asked, or as far as the arm can."""
        for part in LIFT_PARTS:
            lift_m = part * self._config.lift_m
            lift = plan_lift(self._kinematics, self._limits, self.arm_at(t_s), lift_m)
            if not isinstance(lift, Refusal):
                self._next = lift
                self.phase = "lift"
                return
            self.lift_refusal = lift.why
        self.phase = "hold"
