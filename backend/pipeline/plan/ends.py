"""Ends of a plan: which goals are free, and how to leave a start that stands too near to something."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.pipeline.values import PlanRequest, Refusal
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene

LEAVE_STEPS_RAD = (0.02, 0.05, 0.1, 0.2, 0.3)
"""How far, in the joint that moves most, a way out of a safety margin is looked for."""
MAKE_WAY_STEPS_RAD = (*LEAVE_STEPS_RAD, 0.5, 0.8)
"""The same for the way out of where the target will be."""
LEAVE_DIRECTIONS = 24
LEAVE_RESOLUTION_RAD = 0.02
LIMIT_TOLERANCE_RAD = 1e-6
BEYOND_RAD = float(np.pi)
"""How far outside the box of all ends joints are sampled."""
CLOSER_M = 1e-3
"""A way out may come this much nearer to what the start is near to: rounding of the sphere cover."""


@dataclass(frozen=True, eq=False)
class Ends:
    """Where the search starts and what it may end at."""

    lead: Array
    """(n, dof) from ``q_start`` to a free posture; one row when ``q_start`` is free itself."""
    goals: tuple[tuple[int, Array], ...]
    """Index in the request, and the goal; free ones only, preferred first."""

    @property
    def start(self) -> Array:
        return self.lead[-1]


def check_ends(request: PlanRequest, scene: PlanningScene) -> Ends | Refusal:
    """The usable ends of a request; a refusal names what the start or the preferred goal touches."""
    wrong = _malformed(request, scene)
    if wrong is not None:
        return Refusal(wrong)
    goals = np.array(request.goals)
    beyond = _beyond_limits(goals, scene.kinematics.limits)
    free = scene.free_many(goals) & ~beyond.any(axis=1)
    if not free.any():
        why = scene.why_blocked(goals[0]) or f"joint {int(np.argmax(beyond[0])) + 1} beyond its limits"
        return Refusal(f"goal: {why}", checks=len(free))
    lead = _lead_out(request, scene)
    if lead is None:
        return Refusal(f"start: {scene.why_blocked(request.q_start)}", checks=len(free) + 1)
    return Ends(lead, tuple((i, goal) for i, goal in enumerate(request.goals) if free[i]))


def sampled_box(ends: Array, limits: Array) -> Array:
    """(2, dof) lower and upper bounds, in rad, of the postures worth sampling between ``ends`` (n, dof)."""
    lower = np.maximum(limits[0], ends.min(axis=0) - BEYOND_RAD)
    upper = np.minimum(limits[1], ends.max(axis=0) + BEYOND_RAD)
    return np.stack([lower, upper])


def _malformed(request: PlanRequest, scene: PlanningScene) -> str | None:
    if not request.goals:
        return "goal: there is none"
    postures = (request.q_start, *request.goals)
    dof = scene.kinematics.dof
    if any(q.shape != (dof,) or not np.isfinite(q).all() for q in postures):
        return f"start and goals must be {dof} finite joint angles each"
    return None


def _beyond_limits(qs: Array, limits: Array) -> NDArray[np.bool_]:
    """(n, dof) whether each joint is outside ``limits`` (2, dof) by more than rounding."""
    return (qs < limits[0] - LIMIT_TOLERANCE_RAD) | (qs > limits[1] + LIMIT_TOLERANCE_RAD)


def _lead_out(request: PlanRequest, scene: PlanningScene) -> Array | None:
    """``q_start`` when it is free; else the shortest way found out of a margin; None when it touches.

    The target stands in the scene where it will be when it is met: an arm that is there now has to make way for it.
    """
    q = request.q_start
    if scene.is_free(q):
        return q[None]
    clearance_m = scene.clearance_m(q)
    in_its_way = clearance_m <= 0.0
    if in_its_way:
        with scene.without_target():
            if not scene.is_free(q):
                return None
    rng = np.random.default_rng(request.rng_seed)
    directions = [goal - q for goal in request.goals]
    directions.extend(rng.normal(size=(LEAVE_DIRECTIONS, q.size)))
    for step_rad in MAKE_WAY_STEPS_RAD if in_its_way else LEAVE_STEPS_RAD:
        for direction in directions:
            end = q + direction * (step_rad / max(float(np.abs(direction).max()), step_rad))
            if not scene.is_free(end):
                continue
            steps = max(2, int(np.ceil(np.abs(end - q).max() / LEAVE_RESOLUTION_RAD)))
            between = q + np.linspace(0.0, 1.0, steps + 1)[1:-1, None] * (end - q)
            if in_its_way:
                with scene.without_target():
                    clear = bool(scene.free_many(between).all())
            else:
                clear = all(scene.clearance_m(posture) >= clearance_m - CLOSER_M for posture in between)
            if clear:
                return np.stack([q, end])
    return None
