"""Lifts a second: grasps of the databases, lifted one after the other as they are when a database is raced."""

from __future__ import annotations

from collections.abc import Iterator

from backend.bench.figure import Figure
from backend.build.grasps import BRISK
from backend.build.racing import Heat, lifts_per_second
from backend.knowledge.grasps import load_grasps
from backend.objects import OBJECTS
from backend.robots import ROBOTS

WANTED_PER_S = 30.0


def measure(lifts: int, seed: int) -> Iterator[Figure]:
    """Of each robot's hand, with each object and over all of them, on one core.

    Nearly all of these grasps hold, so nearly every lift goes all the way: a race, whose candidates mostly fail early,
    is quicker.
    """
    for robot in ROBOTS:
        all_s = 0.0
        for name in OBJECTS:
            per_s = lifts_per_second(Heat(robot, name, seed, BRISK), load_grasps(robot, name).Ts_object_grasp, lifts)
            all_s += lifts / per_s
            yield Figure(robot, name, per_s, "per s", of=lifts)
        count = lifts * len(OBJECTS)
        yield Figure(robot, "all", count / all_s, "per s", ">=", WANTED_PER_S, count)
