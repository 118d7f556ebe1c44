"""OMPL's PRM behind one function.

``PRM.solve`` looks for solutions in a second thread: when it finds one depends on the wall clock, and with several
goals it waits for Python while Python waits for it. So the roadmap is only grown by OMPL, and searched here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from backend.pipeline.plan.ends import sampled_box
from backend.pipeline.plan.ompl_space import space_information, start_random_numbers
from backend.pipeline.plan.roadmap import Roadmap
from backend.pipeline.plan.seed_path import CheckCount
from backend.pose import Array

NEIGHBOURS = 10
"""How many of the nearest milestones a new one is joined with, at most."""
NEAR_ENDS, NEAR_PATH = 0.5, 0.8
"""Share of the random milestones that are drawn around the ends, where the passages are narrow; or, when there is a
previous path, around it and the ends, where the way around what blocks it is short."""
NEAR_RAD = 1.0
"""How far away from them at most, in each joint; nearer ones are likelier."""


def grow(
    start: Array, goals: Array, seeds: Array, limits: Array, count: CheckCount, max_checks: int, rng_seed: int
) -> tuple[Array, int] | None:
    """Grow a roadmap until the free ``start`` (dof,) and one of the free ``goals`` (m, dof) are joined.

    The first milestones are the start, whatever is free of ``seeds`` (n, dof), and the goals; all others are
    random. Gives the waypoints and the index of the goal, or None when the checks ran out before.
    """
    start_random_numbers(rng_seed)
    stop_at = count.checks + max_checks
    path = np.vstack([start, seeds])
    box = sampled_box(np.vstack([path, goals]), limits)
    milestones = chain(path, goals, _random_milestones(path, goals, box, np.random.default_rng(rng_seed)))
    roadmap = Roadmap()

    def motion_free(a: Array, b: Array) -> bool:
        # As in the first PRM, what is joined already is not joined again: shortcuts come cheaper afterwards.
        if count.checks >= stop_at or roadmap.joined(a, b) or not count.edge_free(a, b):
            return False
        roadmap.join(a, b)
        return True

    def done() -> bool:
        return count.checks >= stop_at or any(roadmap.joined(start, goal) for goal in goals)

    info = space_information(box, count.is_free, motion_free)
    info.setValidStateSamplerAllocator(_sampler(milestones, count, start.size))
    info.setup()
    prm = og.PRM(info)
    prm.setMaxNearestNeighbors(NEIGHBOURS)
    prm.setProblemDefinition(ob.ProblemDefinition(info))
    prm.setup()
    prm.growRoadmapPtc(ob.PlannerTerminationCondition(done))
    for index, goal in enumerate(goals):
        waypoints = roadmap.way(start, goal)
        if waypoints is not None:
            return waypoints, index
    return None


def _random_milestones(path: Array, goals: Array, box: Array, rng: np.random.Generator) -> Iterator[Array]:
    """Postures within the box without end, free or not."""
    near_share = NEAR_PATH if len(path) > 1 else NEAR_ENDS
    while True:
        if rng.random() < near_share:
            # All goals together count as one: the start is as hard to leave, however many there are.
            i = rng.integers(len(path) + 1)
            centre = path[i] if i < len(path) else goals[rng.integers(len(goals))]
            offset = rng.uniform(-NEAR_RAD, NEAR_RAD, centre.size) * rng.random()
            yield np.clip(centre + offset, box[0], box[1])
        else:
            yield rng.uniform(box[0], box[1])


def _sampler(milestones: Iterator[Array], count: CheckCount, dof: int) -> Callable[[Any], Any]:
    """Makes the sampler that hands out ``milestones``, those that are free."""

    class Milestones(ob.ValidStateSampler):
        def sample(self, state: Any) -> bool:
            q = next(milestones)
            state[0:dof] = [float(angle) for angle in q]
            return count.is_free(q)

    def allocate(info: Any) -> Any:
        return Milestones(info)

    return allocate
