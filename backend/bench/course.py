"""Course: one trial as the planner saw it, cycle by cycle, so that its problems can be solved again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.episode import Episode
from backend.kinematics import load_kinematics
from backend.objects import load_object
from backend.pipeline.retime import JointLimits
from backend.pipeline.values import CycleResult, PlanRequest
from backend.pose import Array, Pose
from backend.robots.models import load_model
from backend.scenario import Scenario
from backend.sim.planning_scene import PlanningScene
from backend.snapshot import SceneDescription, Snapshot
from backend.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Problem:
    """What a planner was asked in one cycle."""

    request: PlanRequest
    T_world_object: Pose
    """Where the target was predicted to be."""


@dataclass(frozen=True, eq=False)
class Course:
    """One trial."""

    name: str
    """Of the scenario."""
    description: SceneDescription
    T_world_tray: Pose
    T_world_object: Pose
    """Both at the start."""
    Ts_world_obstacle: Array
    """(n, 4, 4)."""
    limits: JointLimits
    cycles: tuple[CycleResult, ...]
    problems: tuple[Problem, ...]
    """In order; of the cycles that got as far as planning."""
    qs: Array
    """(n, dof) where the arm was at 30 Hz until it went in."""
    followed: tuple[Trajectory, ...]
    """What was in force, one after the other, from the first motion to the end of the lift."""


def run_course(name: str, scenario: Scenario, seed: int) -> Course:
    """Run a trial and keep what its planner was asked."""
    model = load_model(scenario.robot)
    profile = model.description.profiles[scenario.profile]
    home = np.array(model.description.home_rad)
    cycles: list[CycleResult] = []
    qs: list[Array] = []
    followed: list[Trajectory] = []
    first: Snapshot | None = None
    with Episode(scenario, seed) as episode:
        for snapshot in episode.run():
            first = first or snapshot
            if not followed or episode.in_force is not followed[-1]:
                followed.append(episode.in_force)
            if snapshot.phase in ("watch", "move"):
                qs.append(snapshot.q)
            if snapshot.cycle is not None and (not cycles or snapshot.cycle.number != cycles[-1].number):
                cycles.append(snapshot.cycle)
        description = episode.scene
    assert first is not None
    return Course(
        name=name,
        description=description,
        T_world_tray=first.T_world_tray,
        T_world_object=first.T_world_object,
        Ts_world_obstacle=first.Ts_world_obstacle,
        limits=JointLimits(np.array(profile.velocity_rps), np.array(profile.acceleration_rps2)),
        cycles=tuple(cycles),
        problems=_problems(cycles, home),
        qs=np.array(qs),
        followed=tuple(followed),
    )


def scene_of(course: Course) -> PlanningScene:
    """The planner's belief at the start of the trial; ``show`` moves it on."""
    description = course.description
    scene = PlanningScene(load_kinematics(description.robot))
    for name, T in zip(description.obstacles, course.Ts_world_obstacle, strict=True):
        scene.add_object(load_object(name), Pose(T))
    if description.slab is not None:
        scene.add_box(description.slab.size_m, description.slab.T_world_box)
    target = load_object(description.object)
    scene.set_target(target, course.T_world_object, description.tray_size_m, course.T_world_tray)
    return scene


def show(scene: PlanningScene, problem: Problem) -> PlanRequest:
    """Put the target where it was predicted to be; what was asked."""
    scene.move_target(problem.T_world_object)
    return problem.request


def _problems(cycles: list[CycleResult], home: Array) -> tuple[Problem, ...]:
    found: list[Problem] = []
    for cycle in cycles:
        if cycle.picked is None or cycle.prediction is None or cycle.refused_by == "pick":
            continue
        q_start = home if cycle.seed_path is None else cycle.seed_path.waypoints[0]
        goals = tuple(goal.q_pregrasp for goal in cycle.picked.goals)
        request = PlanRequest(q_start, goals, cycle.seed_path, rng_seed=cycle.number + 1)
        found.append(Problem(request, cycle.prediction.pose(1)))
    return tuple(found)
