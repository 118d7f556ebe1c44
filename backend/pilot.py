"""Pilot: decides, with every new observation, whether to think again, to go in, or to correct the way in."""

from __future__ import annotations

import numpy as np

from backend.cycle import Cycle, CycleStart, seen_by
from backend.pipeline.execute import (
    Approach,
    ApproachRequest,
    ArmState,
    Executor,
    can_grasp,
    correct_approach,
    plan_approach,
)
from backend.pipeline.predict import Predictor
from backend.pipeline.retime import stop
from backend.pipeline.think import ThinkTime
from backend.pipeline.values import (
    Candidate,
    CycleResult,
    FailureReason,
    Observation,
    Refusal,
)
from backend.pose import Array
from backend.trajectory import SAME_MOMENT_S, Path, Trajectory

TRACKING_LAST_S = 0.25
"""The approach is no longer corrected when less than this is left of it."""
CORRECT_FROM = (1.5e-3, 0.01)
"""A prediction for the arrival that differs by less, in m and rad, is not worth a correction."""
GIVE_UP_FROM = (0.01, 0.17)
"""Nor is an approach worth going on with that is so far off and cannot be corrected, before the hand slides in."""
GIVE_UP_SLIDING_FROM = (0.025, 0.35)
"""The same while it slides in: the fingers would close on nothing, so there is nothing to lose."""
LATER_FROM = (0.01, 0.17)
"""A hand that would arrive so far off would push the object: it is corrected to the last, and may arrive later."""
LATER_S = 1.0
"""How much later, at most, in one correction."""
TRUST_S = 0.5
"""A grasp that has passed its rehearsal is not rehearsed again for so long."""
PUT_OFF_S = 2.0
PUT_OFF_M = 0.1
"""A grasp that is refused, by pick, in rehearsal or when going in, is not taken again for so long, or until the object
has gone so far: what is refused in one place may do in another."""
SURE_S = 3.0
"""But the grasp that the arm moves to is not put off for what is rehearsed of a meeting further ahead than this: the
prediction will have changed by then, and an arm that turns to another grasp each time gets to none."""


class Pilot:
    """Algorithm 1 of the paper, between observations that come in and an executor that moves the arm."""

    def __init__(self, cycle: Cycle, predictor: Predictor, executor: Executor, think: ThinkTime) -> None:
        self.executor = executor
        self.result: CycleResult | None = None
        """The newest cycle."""
        self.cycles = 0
        self.approach_start_s: float | None = None
        self.approach_refusal = ""
        """Why the approach was last put off."""
        self._cycle = cycle
        self._predictor = predictor
        self._think = think
        self._observed_s = 0.0
        self._fresh = False
        self._busy_until_s = 0.0
        self._held: Candidate | None = None
        self._previous: tuple[Path, Trajectory] | None = None
        self._got_to = 0
        self._put_off_until_s: dict[int, float] = {}
        self._trusted_until_s = 0.0

    def observe(self, observation: Observation) -> None:
        """Take in an observation; once the fingers close, the hand knows better than the eye."""
        if self.executor.phase in ("watch", "move", "approach"):
            self._predictor.observe(observation)
            self._observed_s = observation.t_s
            self._fresh = True

    def consider(self, t_s: float) -> CycleResult | None:
        """Act on what is new, if anything is and no thinking is under way; the cycle if there was one."""
        self.executor.take_over(t_s)
        if not self._fresh or t_s < self._busy_until_s - SAME_MOMENT_S:
            return None
        if self.executor.phase == "approach":
            self._correct(t_s)
        if self.executor.phase == "approach":
            self._fresh = False
            return None
        if self.executor.phase not in ("watch", "move"):
            return None
        self._fresh = False
        if self._near(t_s) and self._go_in(t_s):
            return None
        return self._think_once(t_s)

    def furthest_failure(self) -> FailureReason:
        """Why no approach was begun: the room that none of the cycles got past."""
        reasons: tuple[FailureReason, ...] = ("never_reachable", "no_ik", "no_plan", "belt_end")
        return reasons[self._got_to]

    def _think_once(self, t_s: float) -> CycleResult:
        start = CycleStart(
            number=self.cycles,
            now_s=t_s,
            observed_s=self._observed_s,
            arm_at=self.executor.arm_at,
            held=self._held,
            previous=self._previous,
            put_off=frozenset(i for i, until_s in self._put_off_until_s.items() if t_s < until_s),
            trusted=self._held.index if self._held is not None and t_s < self._trusted_until_s else None,
        )
        result = self._cycle.run(start, self._predictor)
        self.result = result
        self.cycles += 1
        self._busy_until_s = result.effective_s
        if result.shortlist is not None:
            refused = set(result.shortlist.kept) & set(result.shortlist.rejected)
            going_to = None if result.picked is None else result.picked.index
            far = result.prediction is not None and result.prediction.t_s[1] - t_s > SURE_S
            self._put_off(refused - {going_to} if far else refused, t_s)
            if going_to is not None and going_to not in refused | {start.trusted}:
                self._trusted_until_s = t_s + TRUST_S
        self._got_to = max(self._got_to, _progress(result))
        if result.plan is not None and result.trajectory is not None and result.refused_by is None:
            self._held = result.picked
            self._previous = (result.plan.path, result.trajectory)
            self.executor.move_along(result.trajectory)
        elif result.evasion is not None:
            self._held = self._previous = None
            self.executor.move_along(result.evasion)
        return result

    def _near(self, t_s: float) -> bool:
        """CanGrasp, for the moment at which an approach decided on now would begin."""
        if self._held is None:
            return False
        begin_s = t_s + self._think.approach_s()
        Ts_object = self._object_at(np.array([begin_s]))
        grasp = Ts_object[0] @ self._held.T_object_grasp.matrix
        tcp = self._cycle.kinematics.fk(self.executor.arm_at(begin_s).q)
        return can_grasp(tcp, grasp, self._cycle.robot.backoff_m, self._cycle.method.execution)

    def _go_in(self, t_s: float) -> bool:
        """Begin the approach; False when it, or the lift after it, cannot be done."""
        assert self._held is not None
        request = self._request(t_s)
        approach = self._cycle.rehearsal.approach(request)
        if isinstance(approach, Refusal):
            self.approach_refusal = approach.why
            if not self._has_way_to_go(request.arm.t_s):
                self._put_off({self._held.index}, t_s)
            return False
        if self._has_way_to_go(request.arm.t_s):
            brushed = self._cycle.rehearsal.brushes(approach.trajectory, approach.slide_s, self._object_at)
            if brushed:
                self.approach_refusal = f"too early: {brushed}"
                return False
        self.approach_start_s = request.arm.t_s
        self._begin(approach)
        return True

    def _put_off(self, grasps: set[int], t_s: float) -> None:
        here, soon = self._object_at(np.array([t_s, t_s + PUT_OFF_S]))[:, :3, 3]
        gone_m = float(np.linalg.norm(soon - here))
        until_s = t_s + PUT_OFF_S * min(1.0, PUT_OFF_M / max(gone_m, 1e-9))
        self._put_off_until_s |= dict.fromkeys(grasps, until_s)

    def _has_way_to_go(self, t_s: float) -> bool:
        """Whether the motion in force still leads nearer to the pregrasp then."""
        return self._previous is not None and self._previous[1].end_s > t_s

    def _correct(self, t_s: float) -> None:
        """Bend the way in to the newest prediction, if that is wanted, worth it and possible."""
        approach = self.executor.approach
        request = self._request(t_s)
        assert approach is not None
        off = approach.off_by(self._object_at)
        missing = _beyond(off, LATER_FROM)
        last_s = approach.arrive_s - (0.0 if missing else TRACKING_LAST_S)
        too_late = request.arm.t_s > last_s
        if not self._cycle.method.execution.tracking or too_late or not _beyond(off, CORRECT_FROM):
            return
        kinematics, limits = self._cycle.kinematics, self._cycle.limits
        sliding = request.arm.t_s >= approach.slide_s
        if sliding:
            latest_s = approach.arrive_s + (LATER_S if missing else 0.0)
            corrected = correct_approach(kinematics, limits, request, approach, latest_s)
        else:
            corrected = plan_approach(kinematics, limits, request.instead_of(approach))
        if not isinstance(corrected, Refusal):
            corrected = self._cycle.rehearsal.unsafe(corrected, request) or corrected
        if not isinstance(corrected, Refusal):
            self._begin(corrected)
        elif _beyond(off, GIVE_UP_SLIDING_FROM if sliding else GIVE_UP_FROM):
            self._give_up(request.arm, corrected, t_s)

    def _give_up(self, arm: ArmState, refusal: Refusal, t_s: float) -> None:
        """Break the approach off, to think again."""
        assert self._held is not None
        self.approach_refusal = f"given up: {refusal.why}"
        self._put_off({self._held.index}, t_s)
        self._held = self._previous = None
        self.approach_start_s = None
        self.executor.break_off(stop(arm.q, arm.qd, self._cycle.limits, arm.t_s))

    def _request(self, t_s: float) -> ApproachRequest:
        assert self._held is not None
        arm = self.executor.arm_at(t_s + self._think.approach_s())
        return self._cycle.approach_request(arm, self._held.T_object_grasp, self._predictor)

    def _begin(self, approach: Approach) -> None:
        self.executor.begin_approach(approach)
        self._busy_until_s = approach.trajectory.start_s

    def _object_at(self, t_s: Array) -> Array:
        """(n, 4, 4) predicted poses at simulated times (n,)."""
        return seen_by(self._predictor, t_s)


def _beyond(off: tuple[float, float], least: tuple[float, float]) -> bool:
    return off[0] >= least[0] or off[1] >= least[1]


def _progress(result: CycleResult) -> int:
    """How far a cycle got: 0 no grasp reachable, 1 none picked, 2 none planned, 3 a trajectory."""
    match result.refused_by:
        case "sense" | "predict" | "convert" | "filter":
            return 0
        case "pick":
            return 1
        case "plan" | "retime":
            return 2
        case None:
            return 3
