"""RRT-Connect, its tree begun with the previous path."""

from __future__ import annotations

import numpy as np

from backend.methods.method import RrtConnect
from backend.pipeline.plan.ends import Ends
from backend.pipeline.plan.ladder import climb
from backend.pipeline.plan.seed_path import CheckCount, Found, along, without_repeats
from backend.pipeline.plan.shortcut import shorten
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene


class RrtConnectPlanner:
    """The ladder, and at its top trees from the previous path, then from the start alone."""

    grasps_at_once = 1

    def __init__(self, config: RrtConnect) -> None:
        self.config = config

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """See ``Planner.plan``."""
        return climb(request, scene, self._search, seeded=self.config.seeded)

    def _search(self, request: PlanRequest, ends: Ends, chain: Array, count: CheckCount) -> Found | None:
        found = None
        if len(chain) > 1:
            found = self._from_trees(request, ends, chain, "seeded", count)
        return found or self._from_trees(request, ends, ends.start[None], "unseeded", count)

    def _from_trees(self, request: PlanRequest, ends: Ends, chain: Array, how: str, count: CheckCount) -> Found | None:
        """Trees from the states along ``chain``, and the way along it to the tree's root before."""
        from backend.pipeline.plan.ompl_tree import connect

        starts, prefix_of = along(chain)
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
