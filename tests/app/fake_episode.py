"""An engine without physics, to test the dashboard: the arm swings, the object rides, cycles come and go."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from app.commands import Restart
from app.engine import Keepsake, Running, TrialInfo, info_of
from app.wanted import read_scenario, scenario_of
from backend.errors import InvalidInputError, lookup
from backend.events import AddObstacle, MoveObstacle, RemoveObstacle, SetBeltRate, SetSlab, WorldEvent
from backend.knowledge.reach_profile import ReachProfile
from backend.pipeline.values import (
    Candidate,
    Candidates,
    CycleResult,
    JointGoal,
    Outcome,
    Phase,
    Plan,
    Prediction,
    Shortlist,
)
from backend.pose import Array, Pose
from backend.snapshot import BoxPlacement, SceneDescription, Snapshot
from backend.trajectory import Path

LINEAR = Restart(scenario="ur5_linear", seed=0, overrides={})
"""What sessions of the fake engine begin with."""
TICK_S = 1 / 30
HOME = np.array([0.0, -1.15, 0.9, -0.66, 0.0, 0.0])

SCENARIOS = {
    "ur5_linear": ("ur5_linear", "sugar_box", "UR5, linear"),
    "ur5_linear_slab": ("ur5_linear_slab", "cube", "UR5, slab"),
    "mico_varying": ("mico_linear_varying", "cube", "Mico, varying"),
    "boom": ("mico_linear_varying", "cube", "Crashes"),
}
"""Name -> the project's scenario it stands for, object, title."""


class FakeEngine:
    """Runs ``FakeEpisode``; the scenario ``boom`` raises at its 20th tick."""

    def scenario_names(self) -> tuple[str, ...]:
        return tuple(SCENARIOS)

    def object_names(self) -> tuple[str, ...]:
        return ("cube", "sugar_box", "tomato_soup_can")

    def method_names(self) -> tuple[str, ...]:
        return ("ours_rm", "baseline")

    def describe(self, restart: Restart) -> TrialInfo:
        if restart.file is not None:
            return info_of(restart.scenario, scenario_of(restart))
        stands_for, target, title = lookup("scenario", restart.scenario, SCENARIOS)
        overrides = {"object": target, **restart.overrides}
        values = scenario_of(restart.model_copy(update={"scenario": stands_for, "overrides": overrides}))
        return info_of(restart.scenario, values.model_copy(update={"title": title}))

    def seed_in(self, name: str, text: str) -> int:
        return read_scenario(text, name).seed

    def make_episode(self, restart: Restart) -> Running:
        return FakeEpisode(self.describe(restart), restart.seed)

    def reach(self, robot: str) -> ReachProfile:
        radius_m, height_m = np.linspace(0.0, 1.2, 31), np.linspace(0.0, 0.88, 23)
        ball = 0.8 - np.hypot(radius_m[None], height_m[:, None])
        return ReachProfile(radius_m, height_m, np.stack([ball, ball - 0.2]))

    def tcp_trace(self, robot: str, waypoints: Array) -> Array:
        return np.array([tcp_of(q).xyz_m for q in np.linspace(waypoints[0], waypoints[-1], 20)])


def tcp_of(q: Array) -> Pose:
    """A made-up hand that follows the first two joints, looking down."""
    reach = 0.5 + 0.1 * np.sin(q[1])
    return Pose.from_xyz_rpy((reach * np.cos(q[0]), reach * np.sin(q[0]), 0.35 + 0.1 * q[2]), (np.pi, 0.0, q[0]))


class FakeEpisode:
    """20 s of pretending, then success for even seeds and a drop for odd ones; the baseline fails after 10 s."""

    def __init__(self, info: TrialInfo, seed: int) -> None:
        self._info = info
        self._seed = seed
        self._ticks = 300 if info.method == "baseline" else 600
        self._rate = 1.0
        self._s_m = 0.0
        speed = info.speed_mps or 0.02
        self._speed_mps = speed
        self._start = np.array([0.45, -0.5 + 0.02 * (seed % 10), 0.02])
        path = self._start + np.linspace(0.0, 1.0, 60)[:, None] * np.array([0.0, 1.0, 0.0])
        slab = BoxPlacement(Pose.of((0.45, 0.0, 0.45)), (0.1, 0.6, 0.02)) if info.task == "linear_slab" else None
        obstacles = ("tomato_soup_can", "cube", "sugar_box") if slab is None else ()
        self.scene = SceneDescription(info.robot, info.object, (0.12, 0.12, 0.02), path, obstacles, slab, seed)
        self._names: list[str] = list(obstacles)
        self._obstacles = [Pose.of((0.65, -0.3 + 0.3 * i, 0.0)) for i in range(len(obstacles))]
        self._slab = slab
        self.closed = False

    def check(self, event: WorldEvent) -> None:
        if isinstance(event, MoveObstacle | RemoveObstacle) and event.index >= len(self._obstacles):
            raise InvalidInputError("move_obstacle.index: there is no obstacle to move")

    def apply(self, event: WorldEvent) -> None:
        self.check(event)
        match event:
            case SetBeltRate():
                self._rate = event.rate
            case MoveObstacle():
                self._obstacles[event.index] = Pose.from_xyz_yaw((event.x_m, event.y_m, 0.0), event.yaw_rad)
            case AddObstacle():
                self._names.append(event.object)
                self._obstacles.append(Pose.from_xyz_yaw((event.x_m, event.y_m, 0.0), event.yaw_rad))
            case RemoveObstacle():
                del self._names[event.index], self._obstacles[event.index]
            case SetSlab(height_m=None):
                self._slab = None
            case SetSlab(height_m=height_m):
                self._slab = BoxPlacement(Pose.of((0.45, 0.0, 0.03 + (height_m or 0.0))), (0.1, 0.6, 0.02))

    def edited(self, snapshot: Snapshot) -> Snapshot:
        return replace(snapshot, **self._around())

    def _around(self) -> dict[str, Any]:
        poses = [pose.matrix for pose in self._obstacles]
        Ts = np.array(poses).reshape(-1, 4, 4)
        return {"obstacles": tuple(self._names), "Ts_world_obstacle": Ts, "slab": self._slab}

    def close(self) -> None:
        self.closed = True

    def keepsake(self) -> Keepsake:
        return Keepsake({"seed": self._seed, "lift_end_s": 17.5}, f"a trace of {self._info.method}".encode())

    def run(self) -> Iterator[Snapshot]:
        """600 ticks, or 300; every sixth brings a new cycle."""
        cycle = None
        for tick in range(self._ticks + 1):
            if self._info.scenario == "boom" and tick == 20:
                raise ZeroDivisionError("the fake world has come apart")
            if self._info.scenario == "boom" and self._seed == 99:
                os._exit(7)
            for timed in self._info.values.events:
                if timed.tick == tick - 1:
                    self.apply(timed.event)
            self._s_m = float(np.clip(self._s_m + self._rate * self._speed_mps * TICK_S, 0.0, 1.0))
            if tick % 6 == 1:
                cycle = self._cycle(tick)
            yield self._snapshot(tick, cycle)

    def _snapshot(self, tick: int, cycle: CycleResult | None) -> Snapshot:
        t_s = tick * TICK_S
        phases: tuple[Phase, ...] = (
            "watch",
            "move",
            "move",
            "move",
            "approach",
            "close",
            "lift",
            "hold",
            "done",
        )
        last = tick == self._ticks
        good = self._seed % 2 == 0
        outcome = Outcome(good, good, None if good else "dropped", "" if good else "The object slipped away.")
        if self._info.method == "baseline":
            outcome = Outcome(False, False, "belt_end")
        q = self._q(t_s)
        names = joint_names(self._info.robot)
        T_tray = Pose.of(self._start + np.array([0.0, self._s_m, 0.0]))
        return Snapshot(
            tick=tick,
            t_s=t_s,
            phase=phases[min(tick // 75, 8)],
            q=q,
            joints_rad=dict(zip(names, q.tolist(), strict=True)),
            T_world_tcp=tcp_of(q),
            T_world_tray=T_tray,
            T_world_object=T_tray,
            **self._around(),
            belt_rate=self._rate,
            cycle=cycle,
            cycles=cycle.number if cycle else 0,
            outcome=outcome if last else None,
        )

    def _q(self, t_s: float) -> Array:
        return HOME + 0.4 * np.sin(0.5 * t_s) * np.array([1.0, 0.5, 0.5, 0.3, 0.2, 0.2])

    def _cycle(self, tick: int) -> CycleResult:
        t_s = tick * TICK_S
        here = self._start + np.array([0.0, self._s_m, 0.0])
        times = t_s + np.linspace(0.0, 2.0, 9)
        Ts = np.array([Pose.of(here + np.array([0.0, self._speed_mps * (t - t_s), 0.0])).matrix for t in times])
        velocity = np.array([0.0, self._speed_mps, 0.0])
        prediction = Prediction(times, Ts, np.full(9, 0.002), velocity)
        candidates = _candidates(Pose(Ts[-1]))
        kept = tuple(int(i) for i in np.roll(np.arange(30), tick)[:10])
        score = np.linspace(1.0, 0.0, 30)
        others = {i: "others hold better in this motion" for i in range(30) if i not in kept}
        shortlist = Shortlist(candidates, kept, score, others, reachability_m=0.2 * score - 0.05, motion_quality=score)
        shortlist = replace(shortlist, joint_distance_rad={i: 0.8 + 0.1 * rank for rank, i in enumerate(kept[:8])})
        q_start, q_goal = self._q(t_s), self._q(t_s + 2.0) + 0.2
        goal = JointGoal(q_goal, q_goal + 0.05)
        picked = Candidate(kept[0], candidates, (goal,), 0.8)
        path = Path(np.linspace(q_start, q_goal, 6))
        seed_path = Path(np.linspace(q_start + 0.05, q_goal + 0.1, 6))
        return CycleResult(
            number=tick // 6 + 1,
            observed_s=t_s,
            effective_s=t_s + 0.1,
            prediction=prediction,
            shortlist=shortlist,
            picked=picked,
            seed_path=seed_path,
            plan=Plan(path, 0, "reconnected", 120),
            ik_calls=10,
            room_s={
                "sense": 1e-4,
                "predict": 2e-4,
                "filter": 4e-3,
                "pick": 1e-4,
                "plan": 6e-3,
                "retime": 3e-3,
            },
        )


def _candidates(T_world_object: Pose) -> Candidates:
    turns = [Pose.from_xyz_rpy((0.0, 0.0, 0.1), (np.pi + 0.4 * np.sin(a), 0.0, a)) for a in np.linspace(0, 6, 30)]
    Ts_object = np.array([T.matrix for T in turns])
    Ts_world = T_world_object.matrix @ Ts_object
    back = Pose.of((0.0, 0.0, -0.075)).matrix
    return Candidates(Ts_object, Ts_world, Ts_world @ back, np.linspace(1.0, 0.5, 30), T_world_object)


def joint_names(robot: str) -> tuple[str, ...]:
    """The arm's joints as the robots' own descriptions call them."""
    if robot == "mico":
        return tuple(f"m1n6s200_joint_{i}" for i in range(1, 7))
    return tuple(f"{n}_joint" for n in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"))
