"""Retiming: a path becomes the fastest trajectory along it that starts with the arm's current velocity."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from backend.methods.method import Fast, RetimerConfig
from backend.pipeline.retime.curve import Curve
from backend.pipeline.retime.direct import direct
from backend.pipeline.retime.lead_in import STILL_RPS, Approach, approaches
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.retime.two_pass import grid, timed, two_pass
from backend.pipeline.values import Refusal
from backend.pose import Array
from backend.trajectory import Path, Trajectory

FreeEach = Callable[[Array], NDArray[np.bool_]]

CANDIDATES = 3
"""Of so many lead-ins that can be timed, the quickest that touches nothing is taken."""
CHECK_SPACING_RAD = 0.03
MOST_LEAVING_RAD = 0.5
"""A motion may begin inside a safety margin, and must have left it after this way."""


def retime(
    path: Path,
    qd_start: Array,
    limits: JointLimits,
    start_s: float,
    config: RetimerConfig,
    free: FreeEach | None = None,
) -> Trajectory | Refusal:
    """The fastest trajectory from the path's first waypoint at ``qd_start`` to rest at its last.

    With ``Fast``, a moving arm with but one edge before it goes ``direct``, if that touches nothing. Otherwise corners
    are rounded, and a velocity across the path is led into it, so the motion leaves the path a little; ``free``, given
    postures (n, dof), says which touch nothing: a motion that touches is not taken.
    """
    wrong = _malformed(path, qd_start, limits)
    if wrong is not None:
        return Refusal(wrong)
    waypoints = _distinct(path.waypoints)
    own = limits.used(qd_start)
    moving = float(np.linalg.norm(qd_start)) >= STILL_RPS
    if len(waypoints) == 1 and not moving:
        return Trajectory.hold(waypoints[0], start_s)
    if isinstance(config, Fast) and moving and len(waypoints) <= 2:
        quickest = direct(waypoints[0], qd_start, waypoints[-1], own)
        if free is None or _is_free(quickest, free):
            return quickest.shifted(start_s)
    best: Trajectory | None = None
    blocked = False
    timed = _timed_each(approaches(waypoints, qd_start, own), own, config)
    while batch := list(islice(timed, CANDIDATES if moving else 1)):
        best = _quickest_free(batch, free)
        if best is not None:
            break
        blocked = True
    if best is None:
        return Refusal(
            "the rounded path touches something" if blocked else "the path cannot be timed within the limits"
        )
    best.q[0], best.qd[0], best.q[-1] = path.waypoints[0], qd_start, path.waypoints[-1]
    return best.shifted(start_s)


def _malformed(path: Path, qd_start: Array, limits: JointLimits) -> str | None:
    if not limits.usable:
        return "joint limits must be positive and finite"
    if not (np.isfinite(path.waypoints).all() and np.isfinite(qd_start).all()):
        return "path and velocity must be finite"
    over = np.abs(qd_start) / limits.velocity_rps
    if over.max() > 1.001:
        joint = int(np.argmax(over))
        return f"joint {joint + 1} moves at {over[joint]:.2f} times its velocity limit"
    return None


def _distinct(waypoints: Array) -> Array:
    keep = np.concatenate([[True], np.abs(np.diff(waypoints, axis=0)).max(axis=1) > 1e-9])
    return waypoints[keep]


def _timed(approach: Approach, limits: JointLimits, config: RetimerConfig) -> Trajectory | None:
    """The fastest timing of one curve, from time zero; None when it cannot be passed within the limits."""
    curve = approach.curve
    if isinstance(config, Fast):
        speed, feasible = two_pass(
            curve.coefficients,
            curve.lengths,
            limits.velocity_rps,
            limits.acceleration_rps2,
            approach.start_speed,
        )
    else:
        from backend.pipeline.retime.toppra_pass import toppra_speeds

        speed = toppra_speeds(curve, grid_marks(curve), limits, approach.start_speed)
        feasible = speed is not None
    if speed is None or not feasible or not (speed[:-1] + speed[1:] > 1e-9).all():
        return None
    return Trajectory(*timed(curve.coefficients, curve.lengths, speed))


def _timed_each(
    ways: Iterator[Approach], limits: JointLimits, config: RetimerConfig
) -> Iterator[tuple[Curve, Trajectory]]:
    """Those that can be timed."""
    for approach in ways:
        trajectory = _timed(approach, limits, config)
        if trajectory is not None:
            yield approach.curve, trajectory


def _quickest_free(batch: list[tuple[Curve, Trajectory]], free: FreeEach | None) -> Trajectory | None:
    """The quickest trajectory whose curve touches nothing."""
    in_order = sorted(batch, key=lambda entry: entry[1].end_s)
    return next((trajectory for curve, trajectory in in_order if free is None or _stays_free(curve, free)), None)


def grid_marks(curve: Curve) -> Array:
    """(n + 1,) parameters of the grid's nodes along the whole curve."""
    piece, u = grid(curve.coefficients, curve.lengths)
    return np.concatenate([[0.0], curve.marks[piece] + u[:, 1]])


def _stays_free(curve: Curve, free: FreeEach) -> bool:
    count = max(3, int(np.ceil(curve.length / CHECK_SPACING_RAD)))
    s = np.linspace(0.0, curve.length, count)
    return _free_once_left(curve.at(s), s, free)


def _is_free(trajectory: Trajectory, free: FreeEach) -> bool:
    marks = np.concatenate([[0.0], np.linalg.norm(np.diff(trajectory.q, axis=0), axis=1).cumsum()])
    count = max(3, int(np.ceil(marks[-1] / CHECK_SPACING_RAD)))
    s = np.linspace(0.0, marks[-1], count)
    return _free_once_left(trajectory.positions(np.interp(s, marks, trajectory.t_s)), s, free)


def _free_once_left(postures: Array, ways_rad: Array, free: FreeEach) -> bool:
    """Whether a motion through postures (n, dof), so far along it, is free but for its very beginning."""
    ok = free(postures)
    first = int(np.argmax(ok))
    return bool(ok[first:].all()) and ways_rad[first] <= MOST_LEAVING_RAD
