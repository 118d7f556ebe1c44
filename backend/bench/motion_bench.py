"""The whole measurement of motion: trials once, then everything that can be asked of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from backend.bench import inverse, motion, seeding, success, truth
from backend.bench.course import Course, Problem, run_course, scene_of
from backend.bench.figure import Figure
from backend.bench.sizes import SCENARIOS, Size
from backend.pose import Array
from backend.robots import ROBOTS
from backend.scenario import load_scenario, with_overrides
from backend.sim.planning_scene import PlanningScene

Tell = Callable[[str], None]
Answers = dict[tuple[str, bool], list[seeding.Answer]]

TRIED: tuple[tuple[str, bool], ...] = (("rrt_connect", True), ("rrt_connect", False), ("fast", True), ("fast", False))
"""Planners that whole trials are run with; the first one's problems are what all planners are asked."""
MEDIAN_MS, P95_MS = 5.0, 15.0


def measure(size: Size, seed: int, tell: Tell, figures_folder: Path | None = None) -> Iterator[Figure]:
    """Every figure, as soon as it is known."""
    rng = np.random.default_rng(seed)
    courses = {tried: _courses(tried, size, seed, tell) for tried in TRIED}
    followed = [course for tried in TRIED for course in courses[tried]]
    yield from cycle_times(courses)
    paths, figures = _planning(courses[TRIED[0]], size, rng, tell)
    yield from figures
    yield from motion.retiming(courses[TRIED[0]], max(1, size.velocities // size.trials), rng)
    yield from motion.limits(followed)
    for robot in ROBOTS:
        tell(f"IK of {robot}")
        yield from inverse.figures(robot, size.poses, rng)
    tell("against PyBullet")
    yield from truth.figures(courses[TRIED[0]][:: size.trials], paths, size.postures, size.path_postures, rng)
    yield from motion.waviness(courses)
    if figures_folder is not None:
        from backend.bench.seeding_figure import draw_seeding

        chosen = 1 % len(SCENARIOS) * size.trials
        pair = [("seeded", courses[TRIED[0]][chosen]), ("unseeded", courses[TRIED[1]][chosen])]
        tell(f"drawn: {draw_seeding(pair, figures_folder)}")


def cycle_times(courses: dict[tuple[str, bool], list[Course]]) -> Iterator[Figure]:
    """Wall time from predict to retime of the cycles that led to a trajectory."""
    for (kind, seeded), trials in courses.items():
        if not seeded:
            continue
        for robot in ROBOTS:
            mine = [course for course in trials if course.description.robot == robot]
            took_ms = [
                1e3 * sum(cycle.room_s.values())
                for course in mine
                for cycle in course.cycles
                if cycle.trajectory is not None
            ]
            if not took_ms:
                continue
            what = f"{robot}, {kind}: whole cycle"
            n = len(took_ms)
            yield Figure("cycle", f"{what}, median", float(np.median(took_ms)), "ms", "<=", MEDIAN_MS, n)
            yield Figure("cycle", f"{what}, 95 % within", float(np.percentile(took_ms, 95)), "ms", "<=", P95_MS, n)


def _courses(tried: tuple[str, bool], size: Size, seed: int, tell: Tell) -> list[Course]:
    kind, seeded = tried
    overrides = [f"method.planner.kind={kind}", f"method.planner.seeded={str(seeded).lower()}", "timing.think=budget"]
    if size.timeout_s is not None:
        overrides.append(f"timing.timeout_s={size.timeout_s}")
    out: list[Course] = []
    for name in SCENARIOS:
        tell(f"{size.trials} trials of {name}, {kind} {'seeded' if seeded else 'unseeded'}")
        scenario = with_overrides(load_scenario(name), overrides)
        if not out or out[-1].description.robot != scenario.robot:
            run_course(name, with_overrides(scenario, ["timing.timeout_s=1"]), seed)
        out.extend(run_course(name, scenario, seed + trial) for trial in range(size.trials))
    return out


@dataclass(frozen=True, eq=False)
class Asked:
    """What some planners made of the same problems, trial after trial."""

    seeded: tuple[bool, ...]
    """Which kinds of planner are asked."""
    answers: Answers = field(default_factory=dict["tuple[str, bool]", "list[seeding.Answer]"])
    feasible: list[bool] = field(default_factory=list[bool])
    paths: list[tuple[Course, Problem, Array]] = field(default_factory=list["tuple[Course, Problem, Array]"])

    def ask(self, course: Course, scene: PlanningScene, problems: list[Problem]) -> None:
        """Add the answers to the problems of one trial."""
        configs = [kind(seeded=seeded) for kind in seeding.KINDS for seeded in self.seeded]
        answered = [seeding.answers(config, scene, problems) for config in configs]
        for config, mine in zip(configs, answered, strict=True):
            self.answers.setdefault((config.kind, config.seeded), []).extend(mine)
        for i, problem in enumerate(problems):
            found = [mine[i].path for mine in answered]
            self.feasible.append(success.feasible(problem, scene, any(path is not None for path in found)))
            self.paths.extend(
                (course, problem, path.waypoints) for path in found if path is not None and len(path.waypoints) > 1
            )


def _planning(
    courses: list[Course], size: Size, rng: np.random.Generator, tell: Tell
) -> tuple[list[tuple[Course, Problem, Array]], list[Figure]]:
    """What every planner makes of the problems of the trials, and of random ones in their scenes; the paths found."""
    hard, drawn = Asked((True, False)), Asked((True,))
    each, ends = -(-size.problems // size.trials), -(-size.random_ends // size.trials)
    for number, course in enumerate(courses):
        tell(f"planning, trial {number + 1} of {len(courses)}")
        scene = scene_of(course)
        hard.ask(course, scene, seeding.hard_problems(course, each))
        drawn.ask(course, scene, success.random_problems(scene, course.T_world_object, ends, rng))
    figures = seeding.figures(hard.answers)
    figures += success.figures("trials, no straight edge", hard.answers, hard.feasible)
    figures += success.figures("random ends", drawn.answers, drawn.feasible)
    return hard.paths + drawn.paths, figures
