"""CHOMP's parts against finite differences, dense algebra and the scene's own distances."""

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.kinematics.collision import distance_to_body
from backend.kinematics.slopes import slope_of_body
from backend.methods.method import Chomp
from backend.objects import load_object
from backend.pipeline.plan import make_planner
from backend.pipeline.plan.chomp_cost import SELF_SHARE, obstacle_cost
from backend.pipeline.plan.chomp_descent import (
    RATE,
    STEP_RAD,
    bent_line,
    covariant_step,
    inverse_metric,
    keep_within,
    straight_line,
)
from backend.pipeline.values import Plan, PlanRequest, Refusal
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Path

REACH_M = 0.05


@pytest.fixture(params=sorted(ROBOTS), scope="module")
def scene(request: pytest.FixtureRequest) -> PlanningScene:
    scene = PlanningScene(load_kinematics(request.param))
    scene.add_object(load_object("power_drill"), Pose.from_xyz_yaw((0.35, 0.1, 0.0), 0.5))
    scene.add_box((0.1, 1.0, 0.02), Pose.of((0.3, 0.0, 0.45)))
    can = load_object("tomato_soup_can")
    scene.set_target(can, Pose.of((0.3, -0.3, 0.1)), (0.2, 0.2, 0.02), Pose.of((0.3, -0.3, 0.05)))
    return scene


def wandering(scene: PlanningScene, seed: int, count: int = 6) -> Array:
    """A path of ``count`` postures around home, through whatever is there."""
    home = np.array(scene.kinematics.description.home_rad)
    return home + np.cumsum(np.random.default_rng(seed).normal(0.0, 0.25, (count, home.size)), axis=0)


def cost_of(scene: PlanningScene, qs: Array, reach_m: float = REACH_M) -> tuple[float, float, Array]:
    gradient = np.full_like(qs, np.nan)
    cost, least = obstacle_cost(scene.arrays, qs, reach_m, gradient)
    return cost, least, gradient


def test_the_gradient_is_that_of_finite_differences(scene: PlanningScene):
    """Distances have kinks, at which differences say nothing: almost all entries must agree, not all."""
    h = 1e-6
    agreeing: list[bool] = []
    for seed in range(6):
        qs = wandering(scene, seed)
        _, _, gradient = cost_of(scene, qs)
        assert not gradient[0].any() and not gradient[-1].any()
        scale = np.abs(gradient).max()
        for i in range(1, len(qs) - 1):
            for j in range(qs.shape[1]):
                step = np.zeros_like(qs)
                step[i, j] = h
                slope = (cost_of(scene, qs + step)[0] - cost_of(scene, qs - step)[0]) / (2 * h)
                agreeing.append(abs(slope - gradient[i, j]) <= 1e-4 * scale)
        assert scale > 1e-3
    assert np.mean(agreeing) > 0.97


def test_a_path_is_free_exactly_where_no_distance_is_negative(scene: PlanningScene):
    home = np.array(scene.kinematics.description.home_rad)
    qs = home + np.random.default_rng(3).uniform(-1.5, 1.5, (400, home.size))
    free = scene.free_many(qs)
    assert 20 < free.sum() < 380
    for q, is_free in zip(qs, free, strict=True):
        assert (cost_of(scene, np.stack([q, q]))[1] >= 0.0) == is_free


def test_nothing_near_costs_nothing():
    empty = PlanningScene(load_kinematics("ur5_robotiq"))
    home = np.array(empty.kinematics.description.home_rad)
    qs = home + np.random.default_rng(0).uniform(-1.5, 1.5, (400, home.size))
    q = max(qs, key=empty.clearance_m)
    reach_m = 0.5 * empty.clearance_m(q)
    cost, least, gradient = cost_of(empty, q + np.linspace(0.0, 0.001, 5)[:, None], reach_m)
    assert reach_m > 0.005 and cost == 0.0 and least == SELF_SHARE * reach_m and not gradient.any()


def test_the_cost_does_not_depend_on_how_finely_a_path_is_cut(scene: PlanningScene):
    ends = wandering(scene, 1, 2)
    coarse, fine = (cost_of(scene, straight_line(ends[0], ends[1], n))[0] for n in (100, 400))
    assert coarse > 0.0 and fine == pytest.approx(coarse, rel=0.01)


def test_distances_to_bodies_and_their_gradients(scene: PlanningScene):
    bodies = scene.arrays[1]
    rng = np.random.default_rng(0)
    inside = 0
    for body in range(len(bodies[0])):
        middle = bodies[0][body, 9:]
        for x in middle + rng.normal(0.0, 0.07, (300, 3)):
            distance, *gradient = slope_of_body(body, bodies, x[0], x[1], x[2], 0.15)
            known = distance_to_body(body, bodies, x[0], x[1], x[2], 0.15)
            assert distance == pytest.approx(min(known, 0.15), abs=1e-12)
            inside += distance < 0.0
            if distance < 0.15:
                assert np.linalg.norm(gradient) == pytest.approx(1.0)
                y = x + 1e-7 * np.array(gradient)
                ahead = slope_of_body(body, bodies, y[0], y[1], y[2], 0.16)[0]
                assert ahead - distance == pytest.approx(1e-7, rel=0.2)
    assert inside > 20


@pytest.mark.parametrize("count", [3, 10, 24])
def test_the_metric_is_the_integral_of_squared_accelerations(count: int):
    """Against the definition: accelerations by ``np.diff`` between fixed ends, per unit of time, column by column."""
    dt = 1.0 / (count + 1)
    unit = np.eye(count)
    accelerations = np.diff(np.pad(unit, ((1, 1), (0, 0))), n=2, axis=0) / dt**2
    dense = accelerations.T @ accelerations * dt
    np.testing.assert_allclose(inverse_metric(count) @ dense, unit, atol=1e-9)


def test_a_bent_line_keeps_its_ends_and_bends_as_far_as_asked():
    q0, q1 = np.zeros(6), np.arange(6.0)
    path = bent_line(q0, q1, 20, 0.7, np.random.default_rng(0))
    assert np.array_equal(path[0], q0) and np.array_equal(path[-1], q1)
    away = np.abs(path - np.linspace(q0, q1, 22))
    assert away.max() == pytest.approx(0.7) and np.abs(np.diff(path, n=2, axis=0)).max() < 0.2


def test_a_step_is_the_covariant_gradient_of_the_whole_cost():
    """Against dense algebra over all waypoints, ends and all, without the straight line it is written in."""
    n, dof, weight = 12, 4, 0.01
    rng = np.random.default_rng(2)
    path = np.cumsum(rng.normal(0.0, 0.02, (n + 2, dof)), axis=0)
    gradient = rng.normal(0.0, 1e-3, (n + 2, dof))
    differences = np.diff(np.eye(n + 2), n=2, axis=0) * (n + 1) ** 1.5
    smooth = (differences.T @ differences @ path)[1:-1]
    metric = differences[:, 1:-1].T @ differences[:, 1:-1]
    expected = RATE / weight * np.linalg.solve(metric, weight * smooth + gradient[1:-1])
    line = np.linspace(path[0], path[-1], n + 2)
    step = covariant_step(path - line, gradient, inverse_metric(n), weight)
    assert np.abs(expected).max() < STEP_RAD
    np.testing.assert_allclose(step, expected, atol=1e-12)
    capped = covariant_step(path - line, 1e6 * gradient, inverse_metric(n), weight)
    assert np.abs(capped).max() == pytest.approx(STEP_RAD)


def test_without_obstacles_a_bent_path_goes_back_to_the_straight_line():
    path = bent_line(np.zeros(6), np.arange(6.0), 24, 0.5, np.random.default_rng(1))
    line = np.linspace(path[0], path[-1], 26)
    for _ in range(400):
        path[1:-1] -= covariant_step(path - line, np.zeros_like(path), inverse_metric(24), 1e-4)
    assert np.abs(path - line).max() < 1e-3


def test_limits_hold_and_the_way_into_them_is_smooth():
    metric = inverse_metric(20)
    limits = np.array([[-1.0, -1.0], [1.0, 1.0]])
    wave = 1.5 * np.sin(np.linspace(0.0, np.pi, 22))[1:-1]
    qs = np.column_stack([wave, 0.5 * wave])
    keep_within(qs, limits, metric)
    assert np.abs(qs[:, 0]).max() == pytest.approx(1.0) and np.array_equal(qs[:, 1], 0.5 * wave)
    cut_off = np.minimum(wave, 1.0)
    padded = [np.concatenate([[0.0], w, [0.0]]) for w in (qs[:, 0], cut_off)]
    smooth, sharp = (np.abs(np.diff(w, n=2)).max() for w in padded)
    assert smooth < sharp


def turned(q: Array, turn_rad: float) -> Array:
    """The same posture with the base turned."""
    return q + np.array([turn_rad, 0.0, 0.0, 0.0, 0.0, 0.0])


def post_in_the_way(robot: str = "ur5_robotiq", turn_rad: float = 1.6) -> tuple[PlanningScene, PlanRequest]:
    """A turn of the base with a cube where the hand would pass."""
    scene = PlanningScene(load_kinematics(robot))
    q0 = np.array(scene.kinematics.description.home_rad)
    q1 = turned(q0, turn_rad)
    middle = scene.kinematics.fk(0.5 * (q0 + q1))[:3, 3]
    scene.add_box((0.05, 0.05, 0.05), Pose.of(tuple(middle)))
    assert scene.is_free(q0) and scene.is_free(q1) and not scene.edge_free(q0, q1)
    return scene, PlanRequest(q0, (q1,), None, 1)


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_a_straight_line_bends_around_a_post_and_no_further_than_it_must(robot: str):
    scene, request = post_in_the_way(robot)
    plan = make_planner(Chomp(bends=0)).plan(request, scene)
    assert isinstance(plan, Plan) and plan.how == "unseeded"
    line = np.linspace(request.q_start, request.goals[0], len(plan.path.waypoints))
    assert 0.02 < np.abs(plan.path.waypoints - line).max() < 1.0
    assert all(scene.edge_free(a, b) for a, b in zip(plan.path.waypoints, plan.path.waypoints[1:], strict=False))


def test_the_previous_path_is_kept_as_it_is_where_it_still_holds():
    scene, request = post_in_the_way()
    planner = make_planner(Chomp())
    first = planner.plan(request, scene)
    assert isinstance(first, Plan)
    shifted = PlanRequest(request.q_start, (request.goals[0] + 0.01,), first.path, 2)
    again = planner.plan(shifted, scene)
    assert isinstance(again, Plan) and again.how == "reconnected" and again.checks < first.checks
    assert np.abs(again.path.waypoints - first.path.waypoints).max() < 0.02


def test_the_previous_path_is_bent_on_when_something_moved_into_it():
    scene, request = post_in_the_way()
    planner = make_planner(Chomp())
    first = planner.plan(request, scene)
    assert isinstance(first, Plan)
    middle = scene.kinematics.fk(first.path.waypoints[12])[:3, 3]
    post = scene.kinematics.fk(0.5 * (request.q_start + request.goals[0]))[:3, 3]
    for share in np.linspace(0.0, 1.0, 21):
        scene.move_obstacle(0, Pose.of(tuple(post + share * (middle - post))))
        if min(scene.clearance_m(q) for q in first.path.waypoints) < 0.0:
            break
    again = planner.plan(PlanRequest(request.q_start, request.goals, first.path, 2), scene)
    assert isinstance(again, Plan) and again.how == "seeded"


@pytest.mark.parametrize(
    "waypoints", [np.zeros((4, 3)), np.zeros((0, 6)), np.full((3, 6), np.nan), np.zeros(6), np.full((3, 6), 100.0)]
)
def test_a_useless_previous_path_does_no_harm(waypoints: Array):
    scene, request = post_in_the_way()
    seeded = PlanRequest(request.q_start, request.goals, Path(waypoints), 1)
    assert isinstance(make_planner(Chomp()).plan(seeded, scene), Plan)


def add_walls(scene: PlanningScene) -> None:
    """Two walls between which the UR5 stands; a turn of its base by 2.5 rad from home is beyond one."""
    for yaw in (1.25, 3.9):
        scene.add_box((3.0, 0.02, 3.0), Pose.from_xyz_yaw((1.75 * np.cos(yaw), 1.75 * np.sin(yaw), 1.5), yaw))


def test_a_wall_ends_by_counted_steps_and_says_how_many_lines_were_tried():
    scene = PlanningScene(load_kinematics("ur5_robotiq"))
    add_walls(scene)
    start = np.array(scene.kinematics.description.home_rad)
    planner = make_planner(Chomp(iterations=5, bends=2, waypoints=10))
    answer = planner.plan(PlanRequest(start, (turned(start, 2.5),), None, 1), scene)
    assert isinstance(answer, Refusal)
    assert answer.why == "no path to 1 of 1 goals found from 3 lines"
    assert 3 * (5 + 1) * 10 <= answer.checks < 3 * (5 + 1) * 10 + 1000


def test_a_second_goal_is_tried_when_the_first_is_walled_off():
    scene, request = post_in_the_way(turn_rad=-1.0)
    add_walls(scene)
    goals = (turned(request.q_start, 2.5), *request.goals)
    answer = make_planner(Chomp()).plan(PlanRequest(request.q_start, goals, None, 1), scene)
    assert isinstance(answer, Plan) and answer.goal_index == 1 and answer.how == "unseeded"
    only_one = make_planner(Chomp(goals=1, iterations=5)).plan(PlanRequest(request.q_start, goals, None, 1), scene)
    assert isinstance(only_one, Refusal) and only_one.why == "no path to 1 of 2 goals found from 13 lines"
