"""The planner ``fast``: order of goals, every edge checked as it stands, its kernels against plain numpy."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from backend.episode import Episode
from backend.kinematics import load_kinematics
from backend.methods.method import FastLadder
from backend.objects import load_object
from backend.pipeline.plan import make_planner
from backend.pipeline.plan.fast_rungs import first_reached
from backend.pipeline.plan.fast_shortcut import shortened
from backend.pipeline.plan.fast_tree import draw, grow, nearest
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.scenario import load_scenario, with_overrides
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

PLANNER = make_planner(FastLadder())


@pytest.fixture(params=sorted(ROBOTS), scope="module")
def scene(request: pytest.FixtureRequest) -> PlanningScene:
    scene = PlanningScene(load_kinematics(request.param))
    scene.add_object(load_object("bleach_cleanser"), Pose.from_xyz_yaw((0.4, -0.2, 0.0), 0.5))
    scene.add_box((0.1, 1.0, 0.02), Pose.of((0.4, 0.0, 0.45)))
    scene.add_box((0.02, 1.0, 0.5), Pose.of((-0.35, 0.1, 0.25)))
    return scene


def free_postures(scene: PlanningScene, count: int, seed: int) -> Array:
    rng = np.random.default_rng(seed)
    limits = np.clip(scene.kinematics.limits, -np.pi, np.pi)
    qs = rng.uniform(limits[0], limits[1], size=(60 * count, scene.kinematics.dof))
    return qs[scene.free_many(qs)][:count]


def problems(scene: PlanningScene, count: int) -> list[PlanRequest]:
    qs = free_postures(scene, 2 * count, 3)
    return [PlanRequest(qs[2 * i], (qs[2 * i + 1],), None, rng_seed=i + 1) for i in range(count)]


def hard(scene: PlanningScene, count: int) -> list[tuple[PlanRequest, Plan]]:
    """Problems that trees had to be grown for, and the answers."""
    answers = [(request, PLANNER.plan(request, scene)) for request in problems(scene, 30 * count)]
    found = [(request, plan) for request, plan in answers if isinstance(plan, Plan) and plan.how == "unseeded"]
    assert len(found) >= count
    return found[:count]


def assert_edges_free(waypoints: Array, scene: PlanningScene):
    assert scene.is_free(waypoints[0])
    assert all(scene.edge_free(a, b) for a, b in itertools.pairwise(waypoints))


def length_rad(waypoints: Array) -> float:
    return float(np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum())


def test_every_edge_is_free_as_it_stands(scene: PlanningScene):
    rng = np.random.default_rng(0)
    hows: set[str] = set()
    for request, plan in hard(scene, 6):
        assert_edges_free(plan.path.waypoints, scene)
        for _ in range(6):
            goal = request.goals[0] + rng.normal(size=request.q_start.size) * 0.2
            again = PLANNER.plan(replace(request, goals=(goal,), seed_path=plan.path), scene)
            if isinstance(again, Plan):
                hows.add(again.how)
                assert_edges_free(again.path.waypoints, scene)
    assert "reconnected" in hows


def test_a_path_blocked_in_the_middle_is_mended(scene: PlanningScene):
    hows: list[str] = []
    for request, plan in hard(scene, 6):
        waypoints = plan.path.waypoints
        tcp = scene.kinematics.fk(0.5 * (waypoints[0] + waypoints[1]))[:3, 3]
        narrower = PlanningScene(scene.kinematics)
        narrower.add_box((0.06, 0.06, 0.06), Pose.of(tuple(tcp)))
        if not (narrower.is_free(waypoints[0]) and narrower.is_free(waypoints[-1])):
            continue
        answer = PLANNER.plan(replace(request, seed_path=plan.path), narrower)
        assert isinstance(answer, Plan)
        hows.append(answer.how)
        assert_edges_free(answer.path.waypoints, narrower)
    assert len(hows) >= 3


def test_the_first_goal_that_an_edge_reaches_is_taken(scene: PlanningScene):
    start = free_postures(scene, 1, 5)[0]
    goals = free_postures(scene, 30, 6)
    open_ones = [i for i, goal in enumerate(goals) if scene.edge_free(start, goal)]
    assert 2 <= len(open_ones) < 30
    plan = PLANNER.plan(PlanRequest(start, tuple(goals), None, 1), scene)
    assert isinstance(plan, Plan) and plan.how == "straight" and plan.goal_index == open_ones[0]


def test_the_previous_path_is_left_as_early_as_can_be(scene: PlanningScene):
    for request, plan in hard(scene, 4):
        waypoints = plan.path.waypoints
        goal = waypoints[-1]
        reached, follow, checks = first_reached(scene.arrays, waypoints[0], waypoints[1:], goal[None])
        assert reached == 0 and checks > 0
        assert scene.edge_free(waypoints[follow], goal)
        assert not any(scene.edge_free(earlier, goal) for earlier in waypoints[:follow])
        assert request.goals[0] is not goal


def test_an_empty_seed_and_a_start_at_the_goal_are_nothing_special(scene: PlanningScene):
    q = free_postures(scene, 1, 7)[0]
    plan = PLANNER.plan(PlanRequest(q, (q,), Path(q[None]), 1), scene)
    assert isinstance(plan, Plan) and plan.how == "straight" and np.array_equal(plan.path.waypoints, q[None])


def test_short_numbers_and_odd_layouts_are_planned_for(scene: PlanningScene):
    request, plan = hard(scene, 1)[0]
    seed = Path(np.asfortranarray(np.round(plan.path.waypoints)))
    single = replace(request, q_start=request.q_start.astype(np.float32), seed_path=seed)
    answer = PLANNER.plan(single, scene)
    assert isinstance(answer, Plan | Refusal)
    doubled = replace(
        request, q_start=single.q_start.astype(np.float64), seed_path=Path(seed.waypoints.copy(order="C"))
    )
    same = PLANNER.plan(doubled, scene)
    assert type(same) is type(answer) and same.checks == answer.checks


def test_the_budget_ends_a_search_that_cannot_succeed():
    scene = PlanningScene(load_kinematics("ur5_robotiq"))
    start = np.array(scene.kinematics.description.home_rad)
    goal = start + np.array([np.pi, 0.0, 0.0, 0.0, 0.0, 0.0])
    for yaw in (2.57, 5.71):
        scene.add_box((3.0, 0.02, 3.0), Pose.from_xyz_yaw((1.65 * np.cos(yaw), 1.65 * np.sin(yaw), 1.5), yaw))
    seed = Path(np.stack([start, goal]))
    for max_checks in (100, 1000, 10_000):
        planner = make_planner(FastLadder(max_checks=max_checks))
        answers = [planner.plan(PlanRequest(start, (goal,), seed, 1), scene) for _ in range(2)]
        assert all(isinstance(answer, Refusal) for answer in answers)
        assert answers[0].checks == answers[1].checks and max_checks <= answers[0].checks < max_checks + 500


def test_trees_meet_and_shortcuts_only_shorten(scene: PlanningScene):
    limits = np.clip(scene.kinematics.limits, -np.pi, np.pi)
    for i, (request, _) in enumerate(hard(scene, 4)):
        start, goal = request.q_start, request.goals[0]
        starts, goals = ((q[None], np.array([-1])) for q in (start, goal))
        sampling = limits, np.stack([start, goal]), 0.5
        path, checks = grow(scene.arrays, starts, goals, sampling, np.random.default_rng(i), 50_000)
        assert np.array_equal(path[0], start) and np.array_equal(path[-1], goal) and checks > 0
        assert length_rad(path) >= np.linalg.norm(goal - start)
        short, checks = shortened(scene.arrays, path, np.random.default_rng(i))
        assert np.array_equal(short[0], start) and np.array_equal(short[-1], goal) and checks > 0
        assert length_rad(short) < length_rad(path)
        assert_edges_free(short, scene)


def test_nearest_is_numpys():
    rng = np.random.default_rng(4)
    nodes = rng.normal(size=(200, 6))
    for q in rng.normal(size=(50, 6)):
        gaps = np.linalg.norm(nodes - q, axis=1)
        index, gap = nearest(nodes, q)
        assert index == np.argmin(gaps) and gap == pytest.approx(gaps.min(), rel=1e-12)


def test_samples_fill_the_box_and_crowd_around_the_centres():
    box = np.array([[-2.0, -1.0, 0.0], [1.0, 3.0, 0.5]])
    centres = np.array([[0.9, 0.0, 0.25]])
    rng = np.random.default_rng(5)
    q = np.empty(3)
    drawn = {}
    for share in (0.0, 0.8):
        samples = np.empty((4000, 3))
        for row in samples:
            draw((box, centres, share), rng, q)
            row[:] = q
        assert (samples >= box[0]).all() and (samples <= box[1]).all()
        drawn[share] = samples
    assert np.allclose(drawn[0.0].mean(axis=0), box.mean(axis=0), atol=0.08)
    near = {share: np.mean(np.abs(qs - centres[0]).max(axis=1) < 0.5) for share, qs in drawn.items()}
    assert near[0.8] > 4.0 * near[0.0]


def test_a_trial_with_it_moves_to_a_goal_of_the_picked_grasp():
    scenario = with_overrides(load_scenario("ur5_linear_obstacles"), ["method.planner.kind=fast", "timing.timeout_s=4"])
    planned = 0
    with Episode(scenario, 1) as episode:
        for snapshot in episode.run():
            cycle = snapshot.cycle
            if cycle is None or cycle.plan is None or cycle.picked is None:
                continue
            planned += 1
            ends = [np.array_equal(goal.q_pregrasp, cycle.plan.path.waypoints[-1]) for goal in cycle.picked.goals]
            assert any(ends)
    assert planned > 10
