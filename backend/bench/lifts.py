"""Lifts a second: grasps of the databases, lifted one after the other as they are when a database is raced."""

from __future__ import annotations

import time
from collections.abc import Iterator

from backend.bench.figure import Figure
from backend.build.racing import Noise
from backend.build.rig import Rig
from backend.knowledge.grasps import load_grasps
from backend.objects import OBJECTS, load_object
from backend.pose import Pose
from backend.robots import ROBOTS
from backend.robots.models import load_model

WANTED_PER_S = 30.0


def measure(lifts: int, seed: int) -> Iterator[Figure]:
    """Of each robot's hand, with each object and over all of them, on one core.

    Nearly all of these grasps hold, so nearly every lift goes all the way: a race, whose candidates mostly fail early,
    is quicker.
    """
    for robot in ROBOTS:
        all_s = 0.0
        for name in OBJECTS:
            took_s = _took_s(robot, name, lifts, seed)
            all_s += took_s
            yield Figure(robot, name, lifts / took_s, "per s", of=lifts)
        count = lifts * len(OBJECTS)
        yield Figure(robot, "all", count / all_s, "per s", ">=", WANTED_PER_S, count)


def _took_s(robot: str, name: str, lifts: int, seed: int) -> float:
    """Wall time of so many lifts of database grasps in turn; the first world's making is not counted."""
    grasps = load_grasps(robot, name)
    noise = Noise()
    with Rig(load_model(robot), load_object(name)) as rig:
        begun_s = time.perf_counter()
        for i in range(lifts):
            racer = i % len(grasps)
            rig.attempt(Pose(grasps.Ts_object_grasp[racer]), noise.draw(seed, racer, i))
        return time.perf_counter() - begun_s
