"""One control cycle: predict, convert, filter, pick, plan, retime, composed; every output and time is kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from backend.kinematics import Kinematics
from backend.knowledge.grasps import GraspDatabase
from backend.methods import Method
from backend.pipeline.convert import convert
from backend.pipeline.evade import evade
from backend.pipeline.execute import RIDE_S, ApproachRequest, ArmState
from backend.pipeline.filter import RankContext, known_to, shortlist
from backend.pipeline.horizon import Underway, horizons_s, in_time
from backend.pipeline.pick import goals_at_once, pick_nearest
from backend.pipeline.plan import Planner, make_planner
from backend.pipeline.predict import Predictor
from backend.pipeline.reasons import with_others
from backend.pipeline.rehearse import LOOK_EVERY_S, Rehearsal
from backend.pipeline.retime import JointLimits, retime
from backend.pipeline.think import ThinkTime
from backend.pipeline.values import Candidate, CycleResult, JointGoal, PlanRequest, Prediction, Refusal, Room
from backend.pose import Array, Pose
from backend.robots.description import RobotDescription
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path, Trajectory

CANDIDATES_TRIED = 3
"""How often a cycle plans, each time for other grasps, before it gives up."""
WARY_S = 3.0
"""So far ahead a motion is checked against the object as it moves on."""


@dataclass(frozen=True, eq=False)
class CycleStart:
    """What a cycle starts from."""

    number: int
    now_s: float
    observed_s: float
    arm_at: Callable[[float], ArmState]
    """Where the arm will be at a simulated time, by the trajectory in force."""
    held: Candidate | None
    """The grasp the arm is moving to."""
    previous: tuple[Path, Trajectory] | None
    """The plan in force and its timing."""
    put_off: frozenset[int] = frozenset()
    """Grasps not to be taken now: they were refused a moment ago."""
    trusted: int | None = None
    """The grasp the arm is moving to, if it has passed its rehearsal a moment ago."""


class Cycle:
    """The rooms from predict to retime, furnished for one method, robot and object."""

    def __init__(
        self,
        method: Method,
        robot: RobotDescription,
        limits: JointLimits,
        kinematics: Kinematics,
        scene: PlanningScene,
        grasps: GraspDatabase,
        think: ThinkTime,
        rng: np.random.Generator,
    ) -> None:
        self.method = method
        self.robot = robot
        self.limits = limits
        self.kinematics = kinematics
        self.scene = scene
        self._grasps = grasps
        self._think = think
        self._rng = rng
        self._known = known_to(method.filter, grasps)
        self._T_grasp_pregrasp = Pose.of((0.0, 0.0, -robot.backoff_m))
        self._planner: Planner = make_planner(method.planner)
        self.rehearsal = Rehearsal(kinematics, scene, limits, method.execution.lift_m, method.rehearsal)

    def run(self, start: CycleStart, predictor: Predictor) -> CycleResult:
        """Think once. The result holds every room's output up to the first "no"."""
        watch = _Stopwatch()
        begun_s = time.perf_counter()
        result = self._rooms(start, predictor, watch)
        if result.prediction is not None and result.refused_by is not None:
            with watch(result.refused_by):
                result = replace(result, evasion=self._evasion(start, result.effective_s, predictor))
        if self._think.overran(time.perf_counter() - begun_s) and result.refused_by is None:
            result = replace(result, refused_by="retime", why="thinking took longer than it was given")
        return replace(result, room_s=watch.room_s)

    def _rooms(self, start: CycleStart, predictor: Predictor, watch: _Stopwatch) -> CycleResult:
        ready_s = start.now_s + self._think.expected_s()
        result = CycleResult(start.number, start.observed_s, start.now_s + self._think.refused_s(0))
        if start.held is None and predictor.predict(np.array([ready_s])) is None:
            return replace(result, refused_by="predict", why="the object has not been seen yet")
        arm = start.arm_at(ready_s)
        with watch("predict"):
            ways = horizons_s(
                self.method.horizon,
                self._underway(start, arm),
                lambda t_s: seen_by(predictor, t_s),
                self.kinematics,
                self.limits,
            )
        found, picked, ik_calls = result, (), 0
        for ahead_s, only_in_time in ways:
            tried, others = self._picked(start, arm, ahead_s, result, predictor, watch)
            ik_calls += tried.ik_calls
            if others or found is result:
                found, picked = tried, others
            if others and not (only_in_time and not in_time(arm, others[0].goals[0].q_pregrasp, ahead_s, self.limits)):
                break
        charge_s = self._think.expected_s(ik_calls) if picked else self._think.refused_s(ik_calls)
        result = replace(found, ik_calls=ik_calls, effective_s=start.now_s + charge_s)
        if not picked:
            return result
        with watch("pick"):
            picked, result = self._rehearsed(start, result, picked, predictor)
        return self._move(start, result, picked, predictor, watch)

    def _picked(
        self,
        start: CycleStart,
        arm: ArmState,
        ahead_s: float,
        result: CycleResult,
        predictor: Predictor,
        watch: _Stopwatch,
    ) -> tuple[CycleResult, tuple[Candidate, ...]]:
        """The rooms from predict to pick, for a meeting ``ahead_s`` after thinking ends; nearest grasps first."""
        with watch("predict"):
            meeting_s = arm.t_s + ahead_s
            times_s = np.array([arm.t_s, meeting_s, meeting_s + self.method.execution.approach_s])
            prediction = predictor.predict(times_s)
        assert prediction is not None
        with watch("convert"):
            candidates = convert(self._grasps, prediction.pose(1), self.robot.backoff_m)
            self.scene.move_target(prediction.pose(1))
        context = self._context(start, arm, prediction)
        with watch("filter"):
            short = shortlist(self.method.filter, candidates, context)
        if not short.kept:
            why = "no grasp of the database can be reached"
            return replace(result, prediction=prediction, shortlist=short, refused_by="filter", why=why), ()
        with watch("pick"):
            picked, refused = pick_nearest(short, context)
        ways_rad = {candidate.index: candidate.joint_distance_rad for candidate in picked}
        short = replace(short, rejected=with_others(short.rejected, refused), joint_distance_rad=ways_rad)
        result = replace(
            result,
            prediction=prediction,
            shortlist=short,
            ik_calls=2 * len(short.kept),
            refused_by=None if picked else "pick",
            why="" if picked else next(iter(refused.values())),
        )
        return result, picked

    def approach_request(self, arm: ArmState, T_object_grasp: Pose, predictor: Predictor) -> ApproachRequest:
        """The way in from ``arm`` to a grasp of the object, wherever that is predicted to be by then."""
        return ApproachRequest(
            arm=arm,
            object_at=lambda t_s: seen_by(predictor, t_s),
            T_object_grasp=T_object_grasp,
            backoff_m=self.robot.backoff_m,
            slide_s=self.method.execution.approach_s,
            ride_s=RIDE_S,
        )

    def _rehearsed(
        self, start: CycleStart, result: CycleResult, picked: tuple[Candidate, ...], predictor: Predictor
    ) -> tuple[tuple[Candidate, ...], CycleResult]:
        """The picked grasps from the first on that can be gone in for at the predicted pose."""
        prediction, short = result.prediction, result.shortlist
        assert prediction is not None and short is not None

        def request(candidate: Candidate, goal: JointGoal) -> ApproachRequest:
            arm = ArmState(goal.q_pregrasp, np.zeros_like(goal.q_pregrasp), float(prediction.t_s[1]))
            return self.approach_request(arm, candidate.T_object_grasp, predictor)

        picked, refused = self.rehearsal.from_the_first_that_works(picked, start.trusted, request)
        self.scene.move_target(prediction.pose(1))
        if not refused:
            return picked, result
        return picked, replace(result, shortlist=replace(short, rejected=with_others(short.rejected, refused)))

    def _move(
        self,
        start: CycleStart,
        result: CycleResult,
        picked: tuple[Candidate, ...],
        predictor: Predictor,
        watch: _Stopwatch,
    ) -> CycleResult:
        """Plan and retime for the nearest grasp that lets itself be reached without pushing the object on the way."""
        arm = start.arm_at(result.effective_s)
        seed_path = None if start.previous is None else start.previous[0].remaining_from(arm.q)
        left = list(picked)
        for _ in range(CANDIDATES_TRIED):
            if not left:
                break
            asked, choices = goals_at_once(left, start.held, self._planner.grasps_at_once, arm.q)
            with watch("plan"):
                rng_seed = int(self._rng.integers(1, 2**31))
                request = PlanRequest(arm.q, tuple(q for _, q in choices), seed_path, rng_seed)
                plan = self._planner.plan(request, self.scene)
            if isinstance(plan, Refusal):
                result = replace(result, picked=asked[0], seed_path=seed_path, refused_by="plan", why=plan.why)
                left = left[len(asked) :]
                continue
            candidate = choices[plan.goal_index][0]
            with watch("retime"):
                timed = self._timed(arm, plan.path, predictor)
            so_far = replace(result, picked=candidate, seed_path=seed_path, plan=plan)
            if not isinstance(timed, Refusal):
                return replace(so_far, trajectory=timed, refused_by=None, why="")
            result = replace(so_far, refused_by="retime", why=timed.why)
            left.remove(candidate)
        return result

    def _timed(self, arm: ArmState, path: Path, predictor: Predictor) -> Trajectory | Refusal:
        """The motion along a path from ``arm`` on, if it does not touch the object as that moves on."""
        trajectory = retime(path, arm.qd, self.limits, arm.t_s, self.method.retimer, self.scene.free_many)
        if isinstance(trajectory, Refusal):
            return trajectory
        touches = self.rehearsal.brushes(trajectory, arm.t_s + WARY_S, lambda t_s: seen_by(predictor, t_s))
        return Refusal(f"on the way, {touches}") if touches else trajectory

    def _evasion(self, start: CycleStart, from_s: float, predictor: Predictor) -> Trajectory | None:
        in_force = np.array([start.arm_at(t_s).q for t_s in np.arange(from_s, from_s + WARY_S, LOOK_EVERY_S)])
        home = np.array(self.robot.home_rad)
        arm = start.arm_at(from_s)
        return evade(self.rehearsal, self.limits, arm, in_force, lambda t_s: seen_by(predictor, t_s), home)

    def _underway(self, start: CycleStart, arm: ArmState) -> Underway | None:
        if start.held is None or start.previous is None:
            return None
        trajectory = start.previous[1]
        gap_m = float(np.linalg.norm(self.kinematics.fk(arm.q)[:3, 3] - start.held.T_world_pregrasp.xyz_m))
        T_object_pregrasp = start.held.T_object_grasp @ self._T_grasp_pregrasp
        return Underway(arm, trajectory.q[-1], trajectory.end_s - arm.t_s, T_object_pregrasp, gap_m)

    def _context(self, start: CycleStart, arm: ArmState, prediction: Prediction) -> RankContext:
        return RankContext(
            kinematics=self.kinematics,
            scene=self.scene,
            q=arm.q,
            held=None if start.held is None or start.held.index in start.put_off else start.held.index,
            put_off=start.put_off,
            lift_m=self.method.execution.lift_m,
            rng=self._rng,
            known=self._known,
            motion=prediction.motion(1, 2),
        )


def seen_by(predictor: Predictor, t_s: Array) -> Array:
    """(n, 4, 4) predicted poses at simulated times (n,), once there is something to predict from."""
    prediction = predictor.predict(t_s)
    assert prediction is not None
    return prediction.Ts_world_object


class _Stopwatch:
    """Adds up the wall time spent in each room."""

    def __init__(self) -> None:
        self.room_s: dict[Room, float] = {}

    @contextmanager
    def __call__(self, room: Room) -> Generator[None]:
        begun_s = time.perf_counter()
        yield
        self.room_s[room] = self.room_s.get(room, 0.0) + time.perf_counter() - begun_s
