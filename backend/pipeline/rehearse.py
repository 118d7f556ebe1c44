"""Rehearse: whether the way in and the lift after it can be done, before they begin or before a grasp is chosen."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from backend.kinematics import Kinematics
from backend.pipeline.execute import Approach, ApproachRequest, ArmState, plan_approach, plan_lift
from backend.pipeline.execute.approach import ObjectAt
from backend.pipeline.retime import JointLimits
from backend.pipeline.values import Candidate, JointGoal, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Trajectory

LIKELY_CLOSE_S = 0.5
"""About when after the arrival the fingers have closed and the lift begins."""
CHECK_EVERY = 4
"""Knots of the approach between two collision checks, 1/15 s."""
LIFT_LOOKS = 4
"""Postures of the lift that are checked, first and last included."""
MOST_AT_ONCE = 8
"""So many ways in are tried in one cycle, give or take the branches of a grasp."""
LOOK_EVERY_S = 0.1
"""Time between two looks at whether arm and moving object meet."""
LEFT_AFTER = 15
"""Looks, 1.5 s: the hand is drawn out from beside an object in about so long."""


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """What approaches and lifts of one trial are held against."""

    kinematics: Kinematics
    scene: PlanningScene
    limits: JointLimits
    lift_m: float
    wanted: bool = True
    """Without, nothing but the arm's own reach and speed is looked at, and only when it goes in."""

    def approach(self, request: ApproachRequest) -> Approach | Refusal:
        """A way in that is free and that the lift can follow, or why there is none."""
        approach = plan_approach(self.kinematics, self.limits, request)
        return approach if isinstance(approach, Refusal) else self.unsafe(approach, request) or approach

    def from_the_first_that_works(
        self,
        picked: tuple[Candidate, ...],
        trusted: int | None,
        request: Callable[[Candidate, JointGoal], ApproachRequest],
    ) -> tuple[tuple[Candidate, ...], dict[int, str]]:
        """The picked grasps from the first on that passes, on a branch that does, and why those before it do not.

        ``trusted`` has passed a moment ago. When none passes, or none of the first ``MOST_AT_ONCE`` ways in, all are
        given back: there is time until then, and the next cycle tries others.
        """
        if not self.wanted:
            return picked, {}
        refused: dict[int, str] = {}
        tried = 0
        for i, candidate in enumerate(picked):
            if candidate.index == trusted:
                return picked[i:], refused
            if tried >= MOST_AT_ONCE:
                break
            for k, goal in enumerate(candidate.goals):
                tried += 1
                approach = self.approach(request(candidate, goal))
                if not isinstance(approach, Refusal):
                    return (replace(candidate, goals=candidate.goals[k:]), *picked[i + 1 :]), refused
                refused.setdefault(candidate.index, f"in rehearsal: {approach.why}")
        return picked, refused

    def brushes(self, trajectory: Trajectory, until_s: float, object_at: ObjectAt) -> str:
        """What would touch the moving object or its tray before then; empty if nothing."""
        t_s = np.arange(trajectory.start_s, min(until_s, trajectory.end_s), LOOK_EVERY_S)
        found = self.meets(trajectory.positions(t_s), object_at(t_s))
        return "" if found is None else f"in {t_s[found[0]] - trajectory.start_s:.1f} s {found[1]}"

    def meets(self, qs: Array, Ts_world_object: Array) -> tuple[int, str] | None:
        """Which of postures (n, dof), ``LOOK_EVERY_S`` apart, first touches anything as the object moves on, and what.

        A motion may begin in a safety margin, and must have left it after ``LEFT_AFTER`` looks.
        """
        for begun in range(min(LEFT_AFTER, len(qs)) if self.wanted else 0):
            found = self.scene.first_contact(qs[begun:], Ts_world_object[begun:])
            if found is None:
                return None
            if found[0] > 0 or begun == LEFT_AFTER - 1:
                return begun + found[0], found[1]
        return None

    def unsafe(self, approach: Approach, request: ApproachRequest) -> Refusal | None:
        """Why the way in, or the lift that follows it, cannot be done; None when both can.

        Leaves the scene's target where it would be grasped.
        """
        if not self.wanted:
            return None
        trajectory = approach.trajectory
        self.scene.move_target(approach.T_world_object)
        going_in = trajectory.q[trajectory.t_s <= approach.arrive_s + 1e-9][::-CHECK_EVERY]
        free = self.scene.free_many(going_in, target=False)
        if not free.all():
            blocked = going_in[int(free.argmin())]
            return Refusal(f"approach: {self.scene.why_blocked(blocked, target=False)}")
        for lift_s in (approach.arrive_s + LIKELY_CLOSE_S, trajectory.end_s - 1e-3):
            arm = ArmState(*trajectory.sample(lift_s), lift_s)
            lift = plan_lift(self.kinematics, self.limits, arm, self.lift_m)
            if isinstance(lift, Refusal):
                return lift
            touched = self._touched_in(lift, request)
            if touched:
                return Refusal(f"lift: {touched}")
        return None

    def _touched_in(self, lift: Trajectory, request: ApproachRequest) -> str:
        """What the arm would touch while it raises the object and the tray goes on without it; empty if nothing."""
        t_s = np.linspace(lift.start_s, lift.end_s, LIFT_LOOKS)
        qs = lift.positions(t_s)
        carried = self.kinematics.fk_many(qs) @ request.T_object_grasp.inverse().matrix
        found = self.scene.first_contact(qs, carried, request.object_at(t_s), in_hand=True)
        return "" if found is None else found[1]
