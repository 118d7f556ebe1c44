"""Seeded against unseeded: the same successive problems of real trials, none of which a straight edge solves."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from backend.bench.course import Course, Problem, scene_of, show
from backend.bench.figure import Figure
from backend.deviation import deviation
from backend.methods.method import Chomp, FastLadder, PlannerConfig, Prm, RrtConnect
from backend.pipeline.plan import make_planner
from backend.pipeline.values import Plan
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

KINDS: tuple[type[RrtConnect | Prm | Chomp | FastLadder], ...] = (Prm, RrtConnect, Chomp, FastLadder)
WANTED = ("prm", "rrt_connect", "chomp")
"""Planners that the targets are for."""
TIMES_FASTER, TIMES_NEARER = 5.0, 3.0
DENSE_RAD = 0.02


@dataclass(frozen=True, eq=False)
class Answer:
    """One planner's answer to one problem."""

    took_s: float
    path: Path | None
    deviation_rad: float
    """Largest distance from a point of the path to the previous path; NaN where either is missing."""


def hard_problems(course: Course, most: int) -> list[Problem]:
    """Problems with a previous path and without a straight edge to any goal, evenly picked."""
    scene, hard = scene_of(course), list[Problem]()
    for problem in course.problems:
        request = show(scene, problem)
        ends_free = scene.is_free(request.q_start) and bool(scene.free_many(np.array(request.goals)).any())
        blocked = not any(scene.edge_free(request.q_start, goal) for goal in request.goals)
        if request.seed_path is not None and ends_free and blocked:
            hard.append(problem)
    return hard if len(hard) <= most else [hard[i] for i in np.linspace(0, len(hard) - 1, most).astype(int)]


def answers(config: PlannerConfig, scene: PlanningScene, problems: Sequence[Problem]) -> list[Answer]:
    """One planner's answer to every problem of one scene; the first is asked once before, for the compiler."""
    planner = make_planner(config)
    for problem in problems[:1]:
        planner.plan(show(scene, problem), scene)
    out: list[Answer] = []
    for problem in problems:
        request = show(scene, problem)
        begun_s = time.perf_counter()
        plan = planner.plan(request, scene)
        took_s = time.perf_counter() - begun_s
        path = plan.path if isinstance(plan, Plan) else None
        gap = np.nan
        if path is not None and request.seed_path is not None:
            gap = deviation(path.waypoints, request.seed_path.waypoints, DENSE_RAD)
        out.append(Answer(took_s, path, gap))
    return out


def figures(found: dict[tuple[str, bool], list[Answer]]) -> list[Figure]:
    """Ratios of medians, over the problems that both answered."""
    out: list[Figure] = []
    for kind in dict.fromkeys(name for name, _ in found):
        pairs = list(zip(found[kind, True], found[kind, False], strict=True))
        both = [(a, b) for a, b in pairs if a.path is not None and b.path is not None]
        took_ms = [1e3 * np.array([pair[side].took_s for pair in both]) for side in (0, 1)]
        gaps = [np.array([pair[side].deviation_rad for pair in both]) for side in (0, 1)]
        wanted = kind in WANTED
        n = len(both)
        for side, how in enumerate(("seeded", "unseeded")):
            out.append(Figure("seeding", f"{kind} {how}: median time", _median(took_ms[side]), "ms", of=n))
            out.append(Figure("seeding", f"{kind} {how}: median deviation", _median(gaps[side]), "rad", of=n))
        for what, (seeded, unseeded), least in (
            ("faster", took_ms, TIMES_FASTER),
            ("nearer to the previous path", gaps, TIMES_NEARER),
        ):
            ratio = _median(unseeded) / _median(seeded)
            target = least if wanted else None
            out.append(Figure("seeding", f"{kind}: seeded is {what} by", ratio, "x", ">=", target, n))
    return out


def _median(values: Array) -> float:
    return float(np.median(values)) if len(values) else float("nan")
