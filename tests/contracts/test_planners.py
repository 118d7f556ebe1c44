"""What every planner must satisfy."""

import itertools
from typing import get_args

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.methods.method import PlannerConfig, RrtConnect
from backend.objects import load_object
from backend.pipeline.plan import Planner, make_planner
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

CONFIGS = [RrtConnect(), RrtConnect(seeded=False)]
FINE_RAD = 0.007


@pytest.fixture(params=CONFIGS, ids=lambda c: f"{c.kind}-{'seeded' if c.seeded else 'unseeded'}")
def planner(request: pytest.FixtureRequest) -> Planner:
    return make_planner(request.param)


@pytest.fixture(params=sorted(ROBOTS), scope="module")
def scene(request: pytest.FixtureRequest) -> PlanningScene:
    scene = PlanningScene(load_kinematics(request.param))
    for name, x, y in (("bleach_cleanser", 0.4, -0.2), ("power_drill", -0.3, 0.4), ("sugar_box", 0.3, 0.3)):
        scene.add_object(load_object(name), Pose.from_xyz_yaw((x, y, 0.0), 0.5))
    scene.add_box((0.1, 1.0, 0.02), Pose.of((0.4, 0.0, 0.45)))
    return scene


def free_postures(scene: PlanningScene, count: int, seed: int) -> Array:
    home = np.array(scene.kinematics.description.home_rad)
    qs = np.clip(
        home + np.random.default_rng(seed).uniform(-1.6, 1.6, (40 * count, home.size)), *scene.kinematics.limits
    )
    return qs[scene.free_many(qs)][:count]


def requests(scene: PlanningScene, count: int = 12) -> list[PlanRequest]:
    qs = free_postures(scene, 2 * count, seed=5)
    return [PlanRequest(qs[2 * i], (qs[2 * i + 1],), None, rng_seed=i + 1) for i in range(count)]


def hard_request(scene: PlanningScene, planner: Planner) -> Plan:
    """The answer to a request that a straight edge does not answer."""
    for request in requests(scene, 40):
        plan = planner.plan(request, scene)
        if isinstance(plan, Plan) and plan.how == "unseeded" and len(plan.path.waypoints) > 2:
            return plan
    raise AssertionError("no hard request")


def dense(waypoints: Array, step_rad: float) -> Array:
    parts = [
        np.linspace(a, b, max(2, int(np.ceil(np.abs(b - a).max() / step_rad)) + 1))
        for a, b in itertools.pairwise(waypoints)
    ]
    return np.concatenate(parts)


def deviation_rad(path: Array, reference: Array) -> float:
    gaps = np.linalg.norm(dense(path, 0.02)[:, None] - dense(reference, 0.02)[None], axis=2)
    return float(gaps.min(axis=1).max())


def test_every_planner_is_tested():
    kinds = get_args(get_args(PlannerConfig)[0]) or (get_args(PlannerConfig)[0],)
    assert {kind.__name__ for kind in kinds} == {type(config).__name__ for config in CONFIGS}


def test_paths_end_exactly_and_touch_nothing(planner: Planner, scene: PlanningScene):
    solved = 0
    for request in requests(scene):
        plan = planner.plan(request, scene)
        if isinstance(plan, Refusal):
            continue
        solved += 1
        waypoints = plan.path.waypoints
        assert np.array_equal(waypoints[0], request.q_start)
        assert np.array_equal(waypoints[-1], request.goals[plan.goal_index])
        assert min(scene.clearance_m(q) for q in dense(waypoints, FINE_RAD)) > 0.0
    assert solved >= 10


def test_the_same_seed_gives_the_same_path_in_any_order(planner: Planner, scene: PlanningScene):
    asked = requests(scene)
    first = [planner.plan(request, scene) for request in asked]
    for i in np.random.default_rng(0).permutation(len(asked)):
        again, before = planner.plan(asked[i], scene), first[i]
        assert type(again) is type(before)
        if isinstance(again, Plan) and isinstance(before, Plan):
            assert np.array_equal(again.path.waypoints, before.path.waypoints)
            assert (again.how, again.checks) == (before.how, before.checks)


def test_a_start_in_collision_is_refused_in_words(planner: Planner, scene: PlanningScene):
    goal = free_postures(scene, 1, seed=0)[0]
    qs = np.random.default_rng(0).uniform(scene.kinematics.limits[0], scene.kinematics.limits[1], (200, goal.size))
    start = next(q for q in qs if scene.clearance_m(q) < -0.02)
    answer = planner.plan(PlanRequest(start, (goal,), None, 1), scene)
    assert isinstance(answer, Refusal) and answer.why.startswith("start: ") and "too near to" in answer.why


def test_a_goal_in_collision_is_refused_in_words(planner: Planner, scene: PlanningScene):
    start = free_postures(scene, 1, seed=0)[0]
    qs = np.random.default_rng(0).uniform(scene.kinematics.limits[0], scene.kinematics.limits[1], (200, start.size))
    goal = next(q for q in qs if not scene.is_free(q))
    answer = planner.plan(PlanRequest(start, (goal,), None, 1), scene)
    assert isinstance(answer, Refusal) and answer.why == f"goal: {scene.why_blocked(goal)}"


@pytest.mark.parametrize("goals", [(), (np.full(6, np.nan),), (np.zeros(3),)])
def test_malformed_goals_are_refused(planner: Planner, scene: PlanningScene, goals: tuple[Array, ...]):
    start = np.array(scene.kinematics.description.home_rad)
    answer = planner.plan(PlanRequest(start, goals, None, 1), scene)
    assert isinstance(answer, Refusal) and answer.why


def test_a_seed_path_of_another_robot_does_no_harm(planner: Planner, scene: PlanningScene):
    request = requests(scene)[0]
    with_seed = PlanRequest(request.q_start, request.goals, Path(np.zeros((4, 3))), request.rng_seed)
    assert isinstance(planner.plan(with_seed, scene), Plan)


@pytest.mark.timeout(60)
def test_a_walled_in_goal_ends_by_its_budget():
    scene = PlanningScene(load_kinematics("ur5_robotiq"))
    start = np.array(scene.kinematics.description.home_rad)
    goal = start + np.array([2.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    for yaw in (1.25, 3.9):
        scene.add_box((3.0, 0.02, 3.0), Pose.from_xyz_yaw((1.95 * np.cos(yaw), 1.95 * np.sin(yaw), 1.5), yaw))
    answer = make_planner(RrtConnect(max_checks=200)).plan(PlanRequest(start, (goal,), None, 1), scene)
    assert isinstance(answer, Refusal)
    assert answer.why == "no path to any of 1 goals found" and 200 <= answer.checks < 1000


def test_seeding_keeps_to_the_previous_path(scene: PlanningScene):
    seeded, unseeded = (make_planner(config) for config in CONFIGS)
    plan = hard_request(scene, unseeded)
    waypoints = plan.path.waypoints
    start = waypoints[0] + 0.1 * (waypoints[1] - waypoints[0])
    goal = waypoints[-1] + 0.02
    seed = Path(np.vstack([start, waypoints[1:]]))
    again = seeded.plan(PlanRequest(start, (goal,), seed, 99), scene)
    fresh = [unseeded.plan(PlanRequest(start, (goal,), seed, 99 + i), scene) for i in range(3)]
    assert isinstance(again, Plan) and again.how in ("reconnected", "seeded")
    gaps = [deviation_rad(p.path.waypoints, waypoints) for p in fresh if isinstance(p, Plan)]
    assert deviation_rad(again.path.waypoints, waypoints) < np.mean(gaps)
    assert all(isinstance(p, Plan) and p.how == "unseeded" for p in fresh)
