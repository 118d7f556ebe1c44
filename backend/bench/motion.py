"""Retiming from any velocity, limits along all that was executed, and how directly the arm went."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from backend.bench.course import Course
from backend.bench.figure import Figure
from backend.methods.method import Fast
from backend.pipeline.retime import retime
from backend.pose import Array
from backend.trajectory import Trajectory

STILL_RAD = 5e-4
"""A joint that moves less in a thirtieth of a second stands still."""


def retiming(courses: Sequence[Course], count: int, rng: np.random.Generator) -> list[Figure]:
    """Success of retiming the paths of the trials from random velocities within the limits, and in the trials."""
    timed: list[bool] = []
    for course in courses:
        plans = [cycle.plan for cycle in course.cycles if cycle.plan is not None]
        for _ in range(count if plans else 0):
            path = plans[int(rng.integers(len(plans)))].path
            qd = rng.uniform(-1.0, 1.0, path.waypoints.shape[1]) * course.limits.velocity_rps
            timed.append(isinstance(retime(path, qd, course.limits, 0.0, Fast()), Trajectory))
    planned = [cycle for course in courses for cycle in course.cycles if cycle.plan is not None]
    kept = [cycle.refused_by != "retime" for cycle in planned]
    return [
        Figure("retiming", "success from any velocity", _percent(timed), "%", ">=", 99.5, len(timed)),
        Figure("retiming", "success in trials, touching nothing", _percent(kept), "%", ">=", None, len(kept)),
    ]


def limits(courses: Sequence[Course]) -> list[Figure]:
    """Largest velocity and acceleration over their limits, lift included, and jumps where a new motion takes over."""
    fastest, strongest, jump, count = 0.0, 0.0, 0.0, 0
    for course in courses:
        followed = course.followed
        for i, trajectory in enumerate(followed):
            until_s = followed[i + 1].start_s if i + 1 < len(followed) else trajectory.end_s
            qd, qdd = trajectory.peaks(until_s=until_s)
            fastest = max(fastest, float((qd / course.limits.velocity_rps).max()))
            strongest = max(strongest, float((qdd / course.limits.acceleration_rps2).max()))
            count += 1
            if i + 1 < len(followed):
                _, before = trajectory.sample(until_s)
                jump = max(jump, float(np.abs(followed[i + 1].qd[0] - before).max()))
    return [
        Figure("limits", "largest velocity over its limit", fastest, "x", "<=", 1.0, count),
        Figure("limits", "largest acceleration over its limit", strongest, "x", "<=", 1.02, count),
        Figure("limits", "largest jump of velocity at a new plan", jump, "rad/s", "<=", 1e-3, count),
    ]


def waviness(courses: dict[tuple[str, bool], list[Course]]) -> list[Figure]:
    """Joint-space length and direction reversals of what was executed until the arm went in, per trial."""
    out: list[Figure] = []
    for kind in dict.fromkeys(kind for kind, _ in courses):
        ways, turns = ([_mean(of, courses[kind, seeded]) for seeded in (True, False)] for of in (_way_rad, _turns))
        n = len(courses[kind, True])
        for how, way_rad, turned in zip(("seeded", "unseeded"), ways, turns, strict=True):
            out.append(Figure("waviness", f"{kind} {how}: path length per trial", way_rad, "rad", of=n))
            out.append(Figure("waviness", f"{kind} {how}: reversals per trial", turned, of=n))
        for what, (seeded, unseeded) in (("path length", ways), ("reversals", turns)):
            ratio = seeded / max(unseeded, 1e-9)
            out.append(Figure("waviness", f"{kind}: {what}, seeded against unseeded", ratio, "x", "<=", 1.0, n))
    return out


def _mean(of: Callable[[Course], float], trials: Sequence[Course]) -> float:
    return float(np.mean([of(course) for course in trials]))


def _way_rad(course: Course) -> float:
    return float(np.linalg.norm(np.diff(course.qs, axis=0), axis=1).sum())


def _turns(course: Course) -> float:
    return reversals(course.qs)


def reversals(qs: Array) -> int:
    """How often joints turned round, over (n, dof) postures; standing still in between does not count."""
    count = 0
    for moved in np.diff(qs, axis=0).T:
        signs = np.sign(moved[np.abs(moved) > STILL_RAD])
        count += int((signs[1:] != signs[:-1]).sum())
    return count


def _percent(good: Sequence[bool]) -> float:
    return 100.0 * float(np.mean(good)) if good else float("nan")
