"""RRT-Connect, seeded with the previous path: a ladder from the cheapest answer to the dearest."""

from __future__ import annotations

import numpy as np

from backend.methods.method import RrtConnect
from backend.pipeline.plan.ends import Ends, check_ends
from backend.pipeline.plan.seed_path import (
    CheckCount,
    Found,
    reconnected,
    straight,
    valid_chain,
    without_repeats,
)
from backend.pipeline.plan.shortcut import shorten
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

MOST_SEED_STATES = 24
SEED_SPACING_RAD = 0.3


class RrtConnectPlanner:
    """Straight edge; else the previous path reconnected; else trees from it; else from the start alone."""

    def __init__(self, config: RrtConnect) -> None:
        self.config = config

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """See ``Planner.plan``."""
        count = CheckCount(scene)
        ends = check_ends(request, scene)
        if isinstance(ends, Refusal):
            return ends
        found = straight(ends, count)
        if found is None and self.config.seeded:
            found = self._from_seed(request, ends, count)
        if found is None:
            found = self._from_trees(request, ends, ends.start[None], "unseeded", count)
        if found is None:
            return Refusal(f"no path to any of {len(ends.goals)} goals found", count.checks)
        return Plan(Path(without_repeats(found.waypoints)), found.goal_index, found.how, count.checks)

    def _from_seed(self, request: PlanRequest, ends: Ends, count: CheckCount) -> Found | None:
        chain = valid_chain(ends, request.seed_path, count)
        if len(chain) < 2:
            return None
        found = reconnected(ends, chain, count)
        return found or self._from_trees(request, ends, chain, "seeded", count)

    def _from_trees(self, request: PlanRequest, ends: Ends, chain: Array, how: str, count: CheckCount) -> Found | None:
        """Trees from the states along ``chain``, and the way along it to the tree's root before."""
        from backend.pipeline.plan.ompl_tree import connect

        starts, prefix_of = _along(chain)
        found = connect(
            starts,
            np.array([goal for _, goal in ends.goals]),
            count.scene.kinematics.limits,
            count,
            self.config.max_checks // 2 if how == "seeded" else self.config.max_checks,
            request.rng_seed,
        )
        if found is None:
            return None
        before = chain[: prefix_of[found.start_index] + 1]
        rng = np.random.default_rng(request.rng_seed)
        short = shorten(without_repeats(np.vstack([before, found.waypoints])), count, rng)
        return Found(np.vstack([ends.lead[:-1], short]), ends.goals[found.goal_index][0], how)


def _along(chain: Array) -> tuple[Array, list[int]]:
    """(n, dof) states along a chain of waypoints, and for each the waypoint at or before it."""
    length = float(np.linalg.norm(np.diff(chain, axis=0), axis=1).sum())
    spacing = max(SEED_SPACING_RAD, length / MOST_SEED_STATES)
    states, before = [chain[0]], [0]
    for i in range(len(chain) - 1):
        edge = chain[i + 1] - chain[i]
        pieces = max(1, int(np.linalg.norm(edge) / spacing))
        states.extend(chain[i] + edge * (k / pieces) for k in range(1, pieces + 1))
        before.extend([*([i] * (pieces - 1)), i + 1])
    return np.array(states), before
