"""Reports: what the simulation process tells the server."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.commands import Restart
from app.engine import Keepsake
from backend.events import TimedEvent
from backend.knowledge.reach_profile import ReachProfile
from backend.pipeline.values import CycleResult
from backend.pose import Array
from backend.snapshot import SceneDescription, Snapshot

NO_POSES: Array = np.zeros((0, 4, 4))


@dataclass(frozen=True, eq=False)
class Started:
    """A new episode is running."""

    run: int
    """Counts the episodes of this process, from 1."""
    restart: Restart
    scene: SceneDescription
    reach: ReachProfile | None = None
    """Of the robot, where it is known."""


@dataclass(frozen=True, eq=False)
class Traces:
    """Ways of the tcp in the world, for drawing."""

    plan_m: Array | None
    """(n, 3) the current plan."""
    seed_m: Array | None
    """(n, 3) the earlier plan that seeded it."""


@dataclass(frozen=True, eq=False)
class Sight:
    """One world at one tick."""

    snapshot: Snapshot
    traces: Traces | None
    """Of its newest cycle."""


def filled_in(sight: Sight, before: Sight | None) -> Sight:
    """With the cycle that was reported before, where there is no newer; what is over stays the same one."""
    if before is None:
        return sight
    if before.snapshot.outcome is not None:
        return before
    snapshot = sight.snapshot
    if snapshot.cycle is None:
        snapshot = replace(snapshot, cycle=before.snapshot.cycle)
    return Sight(snapshot, sight.traces or before.traces)


@dataclass(frozen=True, eq=False)
class Progress:
    """A tick. To save traffic a cycle travels only once: None means that it is the one reported before.

    Traces come with every new cycle.
    """

    run: int
    snapshot: Snapshot
    traces: Traces | None
    beside: Sight | None = None
    """The same tick of the world compared with."""


@dataclass(frozen=True)
class Edited:
    """A live edit has been made."""

    run: int
    events: tuple[TimedEvent, ...]
    """All of this trial, in their order."""


@dataclass(frozen=True)
class Ended:
    """A trial is over."""

    run: int
    keepsake: Keepsake
    beside: bool = False
    """Whether it is the one compared with."""


@dataclass(frozen=True)
class Pace:
    """How time passes."""

    paused: bool
    speed: float | None
    """Asked simulated seconds per second; None is as fast as it goes."""
    real_time_factor: float
    """Reached simulated seconds per second over the last second; 0 while nothing moves."""


@dataclass(frozen=True)
class Refused:
    """A command that could not be carried out; the simulation goes on."""

    text: str


@dataclass(frozen=True)
class Crashed:
    """The last words of a process that is about to end."""

    cause: str
    traceback: str


Report = Started | Progress | Edited | Ended | Pace | Refused | Crashed


def slim(cycle: CycleResult) -> CycleResult:
    """Without what is heavy and what nobody outside looks at: IK branches, and where each grasp is in the world.

    The latter is ``T_world_object @ Ts_object_grasp``, which stay.
    """
    short = cycle.shortlist
    if short is None:
        return cycle
    candidates = replace(short.candidates, Ts_world_grasp=NO_POSES, Ts_world_pregrasp=NO_POSES)
    return replace(cycle, shortlist=replace(short, candidates=candidates, branches={}))
