"""Planning success on feasible problems: those that some planner solves within ten seconds."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from backend.bench.course import Problem, show
from backend.bench.figure import Figure
from backend.bench.seeding import Answer
from backend.methods.method import FastLadder, RrtConnect
from backend.pipeline.plan import make_planner
from backend.pipeline.values import Plan, PlanRequest
from backend.pose import Pose
from backend.sim.planning_scene import PlanningScene

PATIENCE_S = 10.0
MOST_CHECKS = 1_000_000
LEAST = {"fast": 99.5, "prm": 98.0}
"""Per cent wanted of the seeded planners."""
DRAWS = 200
"""Random postures per one that is wanted free, at most."""


def feasible(problem: Problem, scene: PlanningScene, solved: bool) -> bool:
    """Whether some planner has solved it, or one with next to no budget does within ten seconds."""
    if solved:
        return True
    request = show(scene, problem)
    for config in (FastLadder(max_checks=MOST_CHECKS), RrtConnect(max_checks=MOST_CHECKS)):
        begun_s = time.perf_counter()
        plan = make_planner(config).plan(request, scene)
        if isinstance(plan, Plan) and time.perf_counter() - begun_s <= PATIENCE_S:
            return True
    return False


def random_problems(scene: PlanningScene, T_world_object: Pose, count: int, rng: np.random.Generator) -> list[Problem]:
    """Problems between random free postures within a turn of each joint, without a previous path."""
    scene.move_target(T_world_object)
    limits = np.clip(scene.kinematics.limits, -np.pi, np.pi)
    qs = rng.uniform(limits[0], limits[1], size=(2 * DRAWS * count, scene.kinematics.dof))
    qs = qs[scene.free_many(qs)]
    pairs = min(count, len(qs) // 2)
    return [
        Problem(PlanRequest(qs[2 * i], (qs[2 * i + 1],), None, rng_seed=i + 1), T_world_object) for i in range(pairs)
    ]


def figures(what: str, found: dict[tuple[str, bool], list[Answer]], can_be: Sequence[bool]) -> list[Figure]:
    """Share of the feasible problems that each planner solved."""
    out: list[Figure] = []
    for (kind, seeded), given in found.items():
        solved = [answer.path is not None for answer, can in zip(given, can_be, strict=True) if can]
        share = 100.0 * float(np.mean(solved)) if solved else float("nan")
        target = LEAST.get(kind) if seeded else None
        how = "seeded" if seeded else "unseeded"
        out.append(Figure("success", f"{what}: {kind} {how}", share, "%", ">=", target, len(solved)))
    return out
