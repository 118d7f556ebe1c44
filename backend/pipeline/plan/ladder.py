"""Ladder: what every sampling planner tries before it samples, from the cheapest answer to the dearest."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from backend.pipeline.plan.ends import Ends, check_ends
from backend.pipeline.plan.seed_path import CheckCount, Found, reconnected, straight, valid_chain, without_repeats
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path


class Search(Protocol):
    """The top of the ladder."""

    def __call__(self, request: PlanRequest, ends: Ends, chain: Array, count: CheckCount) -> Found | None:
        """A path between the ends, or None when the budget did not do.

        ``chain`` (n, dof) is what still holds of the previous path; one row, the start, when there is none.
        """
        ...


def climb(request: PlanRequest, scene: PlanningScene, search: Search, *, seeded: bool) -> Plan | Refusal:
    """Straight edge; else the previous path reconnected to a goal; else ``search``.

    Not ``seeded``: the previous path is taken out of the request first.
    """
    if not seeded:
        request = replace(request, seed_path=None)
    count = CheckCount(scene)
    ends = check_ends(request, scene)
    if isinstance(ends, Refusal):
        return ends
    found = straight(ends, count) or _by_previous_path(request, ends, search, count)
    if found is None:
        return Refusal(f"no path to any of {len(ends.goals)} goals found", count.checks)
    return Plan(Path(without_repeats(found.waypoints)), found.goal_index, found.how, count.checks)


def _by_previous_path(request: PlanRequest, ends: Ends, search: Search, count: CheckCount) -> Found | None:
    chain = valid_chain(ends, request.seed_path, count)
    return reconnected(ends, chain, count) or search(request, ends, chain, count)
