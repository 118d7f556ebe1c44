"""PRM, its roadmap initialised with the previous path (paper, section IV-D)."""

from __future__ import annotations

import numpy as np

from backend.methods.method import Prm
from backend.pipeline.plan.ends import Ends
from backend.pipeline.plan.ladder import climb
from backend.pipeline.plan.seed_path import CheckCount, Found, ahead, along, without_repeats
from backend.pipeline.plan.shortcut import shorten
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene


class PrmPlanner:
    """The ladder, and at its top a roadmap, begun with all of the previous path that is free by now."""

    grasps_at_once = 1

    def __init__(self, config: Prm) -> None:
        self.config = config

    def plan(self, request: PlanRequest, scene: PlanningScene) -> Plan | Refusal:
        """See ``Planner.plan``."""
        return climb(request, scene, self._search, seeded=self.config.seeded)

    def _search(self, request: PlanRequest, ends: Ends, chain: Array, count: CheckCount) -> Found | None:
        from backend.pipeline.plan.ompl_roadmap import grow

        limits = count.scene.kinematics.limits
        seeds = _seeds(request, ends, limits)
        goals = np.array([goal for _, goal in ends.goals])
        found = grow(ends.start, goals, seeds, limits, count, self.config.max_checks, request.rng_seed)
        if found is None:
            return None
        path, goal = found
        short = shorten(without_repeats(path), count, np.random.default_rng(request.rng_seed))
        how = "seeded" if len(seeds) else "unseeded"
        return Found(np.vstack([ends.lead[:-1], short]), ends.goals[goal][0], how)


def _seeds(request: PlanRequest, ends: Ends, limits: Array) -> Array:
    """(n, dof) states along the previous path from the start on, also beyond where it is blocked by now."""
    states, _ = along(np.vstack([ends.start, ahead(ends, request.seed_path)]))
    within = ((states >= limits[0]) & (states <= limits[1])).all(axis=1)
    return states[1:][within[1:]]
