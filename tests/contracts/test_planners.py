"""What every planner must satisfy."""

import itertools
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.methods.method import Chomp, FastLadder, PlannerConfig, Prm, RrtConnect
from backend.objects import load_object
from backend.pipeline.plan import Planner, make_planner
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

Kind = type[RrtConnect | Prm | Chomp | FastLadder]
KINDS = [RrtConnect, Prm, Chomp, FastLadder]
SAMPLING = [RrtConnect, Prm, FastLadder]
CONFIGS = [kind(seeded=seeded) for kind in KINDS for seeded in (True, False)]
FINE_RAD = 0.007
GRAZE_M = 1e-4
"""The arm keeps no margin from itself: between two postures that were checked, its spheres may graze each other."""


@pytest.fixture(params=CONFIGS, ids=lambda c: f"{c.kind}-{'seeded' if c.seeded else 'unseeded'}")
def planner(request: pytest.FixtureRequest) -> Planner:
    return make_planner(request.param)


@pytest.fixture(params=sorted(ROBOTS), scope="module")
def scene(request: pytest.FixtureRequest) -> PlanningScene:
    return furnished(request.param)


def furnished(robot: str) -> PlanningScene:
    scene = PlanningScene(load_kinematics(robot))
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


def hard_request(scene: PlanningScene, planner: Planner, least: int = 0) -> PlanRequest:
    """A request that a straight edge does not answer, though the planner does; the first after ``least`` others."""
    for request in requests(scene, 40):
        plan = planner.plan(request, scene)
        if isinstance(plan, Plan) and plan.how == "unseeded" and len(plan.path.waypoints) > 2:
            if least == 0:
                return request
            least -= 1
    raise AssertionError("no hard request")


def hard_path(scene: PlanningScene, planner: Planner) -> Array:
    """The waypoints that answer a hard request."""
    plan = planner.plan(hard_request(scene, planner), scene)
    assert isinstance(plan, Plan)
    return plan.path.waypoints


def dense(waypoints: Array, step_rad: float) -> Array:
    parts = [
        np.linspace(a, b, max(2, int(np.ceil(np.abs(b - a).max() / step_rad)) + 1))
        for a, b in itertools.pairwise(waypoints)
    ]
    return np.concatenate(parts)


def assert_touches_nothing(waypoints: Array, scene: PlanningScene):
    links = scene.kinematics.spheres.names
    for q in dense(waypoints, FINE_RAD):
        if (clearance_m := scene.clearance_m(q)) <= 0.0:
            why = scene.why_blocked(q)
            assert why.split(" too near to ")[1] in links and clearance_m > -GRAZE_M, f"{clearance_m} m: {why}"


def deviation_rad(path: Array, reference: Array) -> float:
    gaps = np.linalg.norm(dense(path, 0.02)[:, None] - dense(reference, 0.02)[None], axis=2)
    return float(gaps.min(axis=1).max())


def test_every_planner_is_tested():
    assert {kind.__name__ for kind in get_args(get_args(PlannerConfig)[0])} == {
        type(config).__name__ for config in CONFIGS
    }


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
        assert_touches_nothing(waypoints, scene)
    assert solved >= 10


def test_most_problems_that_have_a_solution_are_solved(planner: Planner, scene: PlanningScene):
    """Of those that no straight edge solves and that the complete planner, given as much as it needs, does."""
    complete = make_planner(RrtConnect(max_checks=200_000))
    answers = [(request, complete.plan(request, scene)) for request in requests(scene, 60)]
    hard = [request for request, plan in answers if isinstance(plan, Plan) and plan.how != "straight"]
    solved = [isinstance(planner.plan(request, scene), Plan) for request in hard]
    assert len(solved) >= 8 and np.mean(solved) >= 0.7


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


def test_an_arm_where_the_target_will_be_makes_way_for_it(planner: Planner):
    """The scene has the target where it will be met; the rest of the scene is as it is now."""
    scene = furnished("ur5_robotiq")
    qs = free_postures(scene, 60, seed=2)
    target, size_m = load_object("cube"), (0.1, 0.1, 0.02)
    scene.set_target(target, Pose.of((0.0, 0.0, -1.0)), size_m, Pose.of((0.0, 0.0, -1.0)))
    answered = 0
    for start, goal in zip(qs[::2], qs[1::2], strict=False):
        scene.move_target(Pose.of(scene.kinematics.fk(start)[:3, 3] + [0.0, 0.07, 0.0]))
        if scene.clearance_m(start) > 0.0 or not scene.is_free(goal):
            continue
        plan = planner.plan(PlanRequest(start, (goal,), None, 1), scene)
        if isinstance(plan, Plan):
            answered += 1
            np.testing.assert_array_equal(plan.path.waypoints[0], start)
            assert_touches_nothing(plan.path.waypoints[1:], scene)
            with scene.without_target():
                assert scene.free_many(dense(plan.path.waypoints[:2], FINE_RAD)).all()
    assert answered >= 3


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


def test_a_goal_beyond_the_limits_is_refused(planner: Planner, scene: PlanningScene):
    start, free, _ = free_postures(scene, 3, seed=9)
    stiff = PlanningScene(replace(scene.kinematics, limits=np.stack([start, start])))
    answer = planner.plan(PlanRequest(start, (free,), None, 1), stiff)
    assert isinstance(answer, Refusal) and "beyond its limits" in answer.why
    answer = planner.plan(PlanRequest(start, (free, start), None, 1), stiff)
    assert isinstance(answer, Plan) and answer.goal_index == 1


@pytest.mark.parametrize("waypoints", [np.zeros((4, 3)), np.zeros((0, 6)), np.zeros(6), np.full((3, 6), np.nan)])
def test_a_seed_path_that_is_none_does_no_harm(planner: Planner, scene: PlanningScene, waypoints: Array):
    request = hard_request(scene, planner)
    plan = planner.plan(replace(request, seed_path=Path(waypoints)), scene)
    without = planner.plan(request, scene)
    assert isinstance(plan, Plan) and isinstance(without, Plan)
    assert np.array_equal(plan.path.waypoints, without.path.waypoints)


@pytest.mark.timeout(120)
def test_many_goals_are_no_harder_than_one(planner: Planner, scene: PlanningScene):
    goals = free_postures(scene, 40, seed=8)
    hard = [hard_request(scene, planner, least=i) for i in range(4)]
    for request in hard:
        behind = [goal for goal in goals if not scene.edge_free(request.q_start, goal)]
        plan = planner.plan(replace(request, goals=(*request.goals, *behind)), scene)
        assert isinstance(plan, Plan) and plan.how == "unseeded"
        assert np.array_equal(plan.path.waypoints[-1], [*request.goals, *behind][plan.goal_index])
        assert_touches_nothing(plan.path.waypoints, scene)


@pytest.mark.timeout(60)
@pytest.mark.parametrize("kind", SAMPLING)
def test_a_goal_behind_walls_ends_by_its_budget(kind: Kind):
    scene = PlanningScene(load_kinematics("ur5_robotiq"))
    start = np.array(scene.kinematics.description.home_rad)
    goal = start + np.array([2.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    for yaw in (1.25, 3.9):
        scene.add_box((3.0, 0.02, 3.0), Pose.from_xyz_yaw((1.75 * np.cos(yaw), 1.75 * np.sin(yaw), 1.5), yaw))
    answer = make_planner(kind.model_validate({"max_checks": 200})).plan(PlanRequest(start, (goal,), None, 1), scene)
    assert isinstance(answer, Refusal)
    assert answer.why == "no path to any of 1 goals found" and 200 <= answer.checks < 1000


@pytest.mark.parametrize("kind", KINDS)
def test_seeding_keeps_to_the_previous_path(kind: Kind, scene: PlanningScene):
    """Whoever found that path: a planner that begins with a straight line comes back to its own paths unseeded."""
    seeded, unseeded = make_planner(kind()), make_planner(kind(seeded=False))
    waypoints = hard_path(scene, make_planner(RrtConnect(seeded=False)))
    start = waypoints[0] + 0.1 * (waypoints[1] - waypoints[0])
    goal = waypoints[-1] + 0.02
    seed = Path(np.vstack([start, waypoints[1:]]))
    again = seeded.plan(PlanRequest(start, (goal,), seed, 99), scene)
    fresh = [unseeded.plan(PlanRequest(start, (goal,), seed, 99 + i), scene) for i in range(3)]
    assert isinstance(again, Plan) and again.how in ("reconnected", "seeded")
    gaps = [deviation_rad(p.path.waypoints, waypoints) for p in fresh if isinstance(p, Plan)]
    assert deviation_rad(again.path.waypoints, waypoints) < np.mean(gaps)
    assert all(isinstance(p, Plan) and p.how == "unseeded" for p in fresh)


@pytest.mark.parametrize("kind", KINDS)
def test_a_previous_path_that_is_blocked_by_now_is_left_in_time(kind: Kind):
    scene = furnished("ur5_robotiq")
    waypoints = hard_path(scene, make_planner(kind(seeded=False)))
    between = dense(waypoints, 0.02)
    middle = scene.kinematics.fk(between[len(between) // 2])
    scene.add_box((0.05, 0.05, 0.05), Pose.of(tuple(middle[:3, 3])))
    assert not all(scene.free_many(between)) and scene.is_free(waypoints[0]) and scene.is_free(waypoints[-1])
    request = PlanRequest(waypoints[0], (waypoints[-1],), Path(waypoints), 3)
    plan, again = (make_planner(kind()).plan(request, scene) for _ in range(2))
    assert isinstance(plan, Plan) and isinstance(again, Plan)
    assert np.array_equal(plan.path.waypoints, again.path.waypoints)
    assert_touches_nothing(plan.path.waypoints, scene)
