"""Racing: many grasps are lifted a few times, the better ones oftener, the best oftenest; on all cores, resumable."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.build.rig import Rig, RigSettings
from backend.objects import load_object
from backend.parallel import spread
from backend.pose import Array, Pose
from backend.robots.models import load_model

Counts = NDArray[np.int64]
RACERS_PER_TASK = 6
Todo = tuple[int, Array, int, int]
"""Racer's number, grasp (4, 4), lifts done, lifts wanted."""


@dataclass(frozen=True)
class Noise:
    """How far the object may be from where it is believed; uniform."""

    xy_m: float = 0.01
    yaw_rad: float = float(np.radians(20.0))

    def draw(self, seed: int, racer: int, lift: int) -> Pose:
        """The same for the same three numbers, whoever asks and when."""
        rng = np.random.default_rng((seed, racer, lift))
        x, y = rng.uniform(-self.xy_m, self.xy_m, 2)
        return Pose.from_xyz_yaw((x, y, 0.0), rng.uniform(-self.yaw_rad, self.yaw_rad))


@dataclass(frozen=True)
class Heat:
    """What every worker needs to know."""

    robot: str
    object: str
    seed: int
    rig: RigSettings
    noise: Noise = field(default_factory=Noise)


@dataclass(eq=False)
class Racers:
    """All racers of one object and hand, and how they have done so far."""

    Ts_object_grasp: Array
    """(n, 4, 4)."""
    lifts: Counts
    """(n,)."""
    successes: Counts
    """(n,)."""
    slip_m: Array
    """(n,) summed over the lifts that held."""

    @staticmethod
    def of(Ts_object_grasp: Array) -> Racers:
        """Nobody has been lifted yet."""
        n = len(Ts_object_grasp)
        return Racers(Ts_object_grasp, np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n))

    def note(self, racer: int, lifts: int, successes: int, slip_m: float) -> None:
        """Add the outcome of some more lifts of one racer."""
        self.lifts[racer] += lifts
        self.successes[racer] += successes
        self.slip_m[racer] += slip_m

    def only(self, numbers: Counts) -> Racers:
        """Those of these numbers, copied."""
        return Racers(**{name: array[numbers] for name, array in self.arrays().items()})

    def arrays(self) -> dict[str, Any]:
        """All arrays by name."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    @property
    def estimate(self) -> Array:
        """(n,) success rates, drawn towards one half while lifts are few."""
        return (self.successes + 1.0) / (self.lifts + 2.0)

    @property
    def mean_slip_m(self) -> Array:
        """(n,)."""
        return self.slip_m / np.maximum(self.successes, 1)


Task = tuple[Heat, list[Todo]]


def race(heat: Heat, racers: Racers, numbers: Counts, lifts: int, workers: int) -> Iterator[None]:
    """Bring the racers of these ``numbers`` to ``lifts`` lifts; yields now and then. The order does not matter."""
    todo: list[Todo] = [
        (int(r), racers.Ts_object_grasp[r], int(racers.lifts[r]), lifts) for r in numbers if racers.lifts[r] < lifts
    ]
    tasks = [(heat, todo[i : i + RACERS_PER_TASK]) for i in range(0, len(todo), RACERS_PER_TASK)]
    for outcomes in spread(_lift_some, tasks, max(min(workers, len(tasks)), 1)):
        for racer, done, held, slip_m in outcomes:
            racers.note(racer, done, held, slip_m)
        yield


@cache
def _rig(heat: Heat) -> Rig:
    """One per process."""
    return Rig(load_model(heat.robot), load_object(heat.object), heat.rig)


def _lift_some(task: Task) -> list[tuple[int, int, int, float]]:
    """(racer, lifts, successes, summed slip) of each racer of a task."""
    heat, todo = task
    rig = _rig(heat)
    outcomes: list[tuple[int, int, int, float]] = []
    for racer, T, done, wanted in todo:
        grasp = Pose(T)
        if done == 0 and not rig.is_clear(grasp):
            outcomes.append((racer, wanted, 0, 0.0))
            continue
        tries = [rig.attempt(grasp, heat.noise.draw(heat.seed, racer, k)) for k in range(done, wanted)]
        held = [attempted.slip_m for attempted in tries if attempted.held]
        outcomes.append((racer, len(tries), len(held), float(sum(held))))
    return outcomes


def lifts_per_second(heat: Heat, Ts_object_grasp: Array, count: int) -> float:
    """How many lifts of these grasps in turn one process does in a second, its world once made."""
    todo = [(k, Ts_object_grasp[k % len(Ts_object_grasp)], 1, 2) for k in range(count)]
    _lift_some((heat, todo[:1]))
    begun_s = time.perf_counter()
    _lift_some((heat, todo))
    return count / (time.perf_counter() - begun_s)
