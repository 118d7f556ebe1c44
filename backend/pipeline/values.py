"""What the rooms of one cycle hand to each other. All are frozen; arrays are never written after they are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from backend.pose import Array, Pose
from backend.trajectory import Path, Trajectory

Phase = Literal["watch", "move", "approach", "close", "lift", "hold", "done"]

FailureReason = Literal[
    "never_reachable",
    "no_ik",
    "no_plan",
    "approach_missed",
    "dropped",
    "knocked_obstacle",
    "belt_end",
    "object_fell",
    "timeout",
    "error",
]

Room = Literal["sense", "predict", "convert", "filter", "pick", "plan", "retime"]


@dataclass(frozen=True, eq=False)
class Observation:
    """What the robot senses at one moment."""

    t_s: float
    """Simulated time at which the world was in this state (not when the robot learns of it)."""
    q: Array
    """(dof,) rad."""
    qd: Array
    """(dof,) rad/s."""
    T_world_object: Pose | None
    """None when the detection dropped out."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """Where the object will be, at several moments."""

    t_s: Array
    """(n,) simulated times, increasing."""
    Ts_world_object: Array
    """(n, 4, 4)."""
    position_std_m: Array
    """(n,) one standard deviation along the most uncertain axis; zero where a predictor claims no uncertainty."""
    velocity_mps: Array
    """(3,) estimated velocity of the object now."""

    def pose(self, index: int) -> Pose:
        return Pose(self.Ts_world_object[index])

    def motion(self, begin: int, end: int) -> PlanarMotion:
        """From one moment to a later one, in the object's own frame at the first."""
        moved = self.Ts_world_object[end, :3, 3] - self.Ts_world_object[begin, :3, 3]
        x, y, _ = self.Ts_world_object[begin, :3, :3].T @ moved
        took_s = float(self.t_s[end] - self.t_s[begin])
        return PlanarMotion(float(np.hypot(x, y)) / took_s, float(np.arctan2(y, x)))


@dataclass(frozen=True)
class PlanarMotion:
    """Where an object goes, in the xy plane of its own frame."""

    speed_mps: float
    direction_rad: float
    """From the object's x axis; of no meaning where the speed is next to nothing."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """Every grasp of the database, moved to where the object is predicted to be."""

    Ts_object_grasp: Array
    """(n, 4, 4), tcp in the object frame."""
    Ts_world_grasp: Array
    """(n, 4, 4)."""
    Ts_world_pregrasp: Array
    """(n, 4, 4)."""
    quality: Array
    """(n,) measured lift success of each grasp."""
    T_world_object: Pose
    """The predicted pose the grasps were moved to."""


@dataclass(frozen=True, eq=False)
class Shortlist:
    """The grasps worth an IK, best first, and why the others are not."""

    candidates: Candidates
    kept: tuple[int, ...]
    """Indices into ``candidates``, best first."""
    score: Array
    """(n,) of every candidate, larger is better; NaN where the filter does not score."""
    rejected: Mapping[int, str]
    """Index -> reason."""
    branches: dict[int, tuple[JointGoal, ...]] = field(default_factory=dict["int", "tuple[JointGoal, ...]"])
    """IK solutions that a filter has found already, by index."""
    reachability_m: Array | None = None
    """(n,) what reachability said of each, where it was asked; positive is reachable."""
    motion_quality: Array | None = None
    """(n,) probability that each holds in the predicted motion, where it was asked for."""
    joint_distance_rad: dict[int, float] = field(default_factory=dict["int", "float"])
    """How far the arm has to go to each that could be picked, by index."""


@dataclass(frozen=True, eq=False)
class JointGoal:
    """One IK branch of a grasp."""

    q_pregrasp: Array
    """(dof,) rad."""
    q_grasp: Array
    """(dof,) rad; on the same branch as ``q_pregrasp``."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """The picked grasp with its joint goals, nearest first."""

    index: int
    among: Candidates
    """What ``index`` counts in."""
    goals: tuple[JointGoal, ...]
    """At least one; the nearest to the arm's configuration first."""
    joint_distance_rad: float
    """To the first goal: ``max |q_pregrasp - q| + max |q_grasp - q|``."""

    @cached_property
    def T_object_grasp(self) -> Pose:
        return Pose(self.among.Ts_object_grasp[self.index])

    @cached_property
    def T_world_grasp(self) -> Pose:
        return Pose(self.among.Ts_world_grasp[self.index])

    @cached_property
    def T_world_pregrasp(self) -> Pose:
        return Pose(self.among.Ts_world_pregrasp[self.index])


@dataclass(frozen=True, eq=False)
class PlanRequest:
    """From where to where, and what the previous answer was."""

    q_start: Array
    """(dof,) rad."""
    goals: tuple[Array, ...]
    """(dof,) rad each, preferred first."""
    seed_path: Path | None
    """What is left of the previous plan; None when there is none."""
    rng_seed: int


@dataclass(frozen=True, eq=False)
class Plan:
    """A path, and how it came about."""

    path: Path
    goal_index: int
    """Of the request's goals."""
    how: str
    """Which step of the planner's ladder found it: ``straight``, ``reconnected``, ``seeded`` or ``unseeded``."""
    checks: int
    """State checks it cost."""


@dataclass(frozen=True)
class Refusal:
    """An expected "no", with its reason in words."""

    why: str
    checks: int = 0
    """State checks it cost, where a planner refused."""


@dataclass(frozen=True, eq=False)
class CycleResult:
    """Every room's output up to the first "no", and each room's time."""

    number: int
    observed_s: float
    """Time of the observation the cycle started from."""
    effective_s: float
    """Simulated time at which the result took, or takes, effect."""
    prediction: Prediction | None = None
    shortlist: Shortlist | None = None
    picked: Candidate | None = None
    seed_path: Path | None = None
    plan: Plan | None = None
    trajectory: Trajectory | None = None
    evasion: Trajectory | None = None
    """Out of the object's way, where there is no trajectory to a grasp and the arm would be run into."""
    refused_by: Room | None = None
    """The room that said no."""
    why: str = ""
    """Its reason, in words."""
    ik_calls: int = 0
    room_s: dict[Room, float] = field(default_factory=dict["Room", float])
    """Wall time of each room, seconds. No decision reads it unless thinking time is ``measured``."""


@dataclass(frozen=True)
class Outcome:
    """How a trial ended."""

    strict: bool
    """At the end of the hold: >= 5 cm above where it was grasped, held by the gripper alone, no obstacle knocked."""
    authors: bool
    """The rule of the paper's released evaluation: the object >= 3 cm above where it stood."""
    reason: FailureReason | None
    """Why ``strict`` is False; None when it is True."""
    detail: str = ""
    """One plain sentence."""
