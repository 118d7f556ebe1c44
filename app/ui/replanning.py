"""Replanning: what is new in a plan against what was left of the one before, which seeded it."""

from __future__ import annotations

from dataclasses import dataclass

from app.reports import Traces
from backend.deviation import deviation, length
from backend.pipeline.values import CycleResult

SPACING_RAD, SPACING_M = 0.02, 0.01
SAME_RAD = 0.005
FOLLOWS_RAD = 0.1
"""Up to here the new plan is said to follow the one before."""
CM_PER_M = 100.0


@dataclass(frozen=True)
class Change:
    """Of a plan against its seed; (joint space in rad, hand in m)."""

    apart: tuple[float, float]
    """Largest distance of a point of the new plan from the seed."""
    before: tuple[float, float]
    """Length of what was left of the plan before."""
    after: tuple[float, float]
    """Length of the new plan."""


def change(cycle: CycleResult, traces: Traces | None) -> Change | None:
    """None where there is no new plan, or none before it."""
    plan, seed = cycle.plan, cycle.seed_path
    if plan is None or seed is None or traces is None or traces.plan_m is None or traces.seed_m is None:
        return None
    apart_rad = deviation(plan.path.waypoints, seed.waypoints, SPACING_RAD)
    apart_m = deviation(traces.plan_m, traces.seed_m, SPACING_M)
    return Change(
        (apart_rad, apart_m),
        (seed.length_rad, length(traces.seed_m)),
        (plan.path.length_rad, length(traces.plan_m)),
    )


def change_words(cycle: CycleResult, traces: Traces | None) -> str:
    """In one or two sentences."""
    if cycle.plan is None:
        makes_way = " The arm makes way for the object." if cycle.evasion is not None else ""
        return f"No new plan: {cycle.why or 'none was asked for'}.{makes_way}" if cycle.refused_by else "No plan yet."
    if cycle.seed_path is None:
        return "A first plan: there was none before to follow."
    found = change(cycle, traces)
    if found is None:
        return "Nothing is known of the plan before."
    if found.apart[0] < SAME_RAD:
        return f"The new plan is what was left of the one before: {_both(found.after)} at the hand."
    verb = "follows" if found.apart[0] <= FOLLOWS_RAD else "departs from"
    return (
        f"The new plan {verb} the one before: at most {_both(found.apart)} apart at the hand. "
        f"Its length is {_both(found.after)}, that of what was left {_both(found.before)}."
    )


def _both(figure: tuple[float, float]) -> str:
    rad, m = figure
    return f"{rad:.2f} rad or {CM_PER_M * m:.1f} cm"
