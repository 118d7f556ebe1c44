"""Every task draws what the paper says, the same for the same seed, and with nothing touching anything."""

import math
from typing import Any

import numpy as np
import pytest
from oracle_coal import box_solid, object_solid, sphere_solids
from pydantic import TypeAdapter, ValidationError
from scipy import stats

from backend.errors import InvalidInputError
from backend.kinematics.kinematics import load_kinematics
from backend.motions import LinearMotion
from backend.objects import OBJECTS, OBSTACLES, load_object
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.tasks import TASKS, BeltTask, TrialSetup
from backend.tasks.belt import DrawnBelt
from backend.tasks.linear_obstacles import LinearObstacles, subregions
from backend.tasks.setup import base_points

NO_ARM = np.empty((0, 4))
SEEDS = range(60)


def make(kind: str, **settings: Any) -> BeltTask:
    """A task at the paper's UR5 ranges, unless told otherwise."""
    varying = kind == "linear_varying"
    speed = {"start_speed_mps": 0.03, "end_speed_mps": 0.05} if varying else {"speed_mps": 0.05}
    return TASKS[kind].model_validate({"distance_min_m": 0.3, "distance_max_m": 0.7, **speed, **settings})


def drawn(task: BeltTask, seed: int, arm: Array = NO_ARM, target: str = "cube") -> TrialSetup:
    return task.draw(np.random.default_rng(seed), load_object(target), arm)


def arm_at_home(robot: str) -> Array:
    kinematics = load_kinematics(robot)
    return kinematics.spheres_world(np.array(kinematics.description.home_rad))


def ranges(robot: str) -> dict[str, float]:
    low, high = (0.15, 0.4) if robot == "mico" else (0.3, 0.7)
    return {"distance_min_m": low, "distance_max_m": high}


def numbers(setup: TrialSetup) -> list[float]:
    """All that was drawn, flat."""
    poses = [pose for _, pose in setup.obstacles] + ([setup.slab.T_world_box] if setup.slab else [])
    way = setup.motion.path_world(5)
    parts = [
        way.ravel(),
        [setup.object_yaw_rad, setup.motion.duration_s],
        *(pose.matrix.ravel() for pose in poses),
    ]
    return [float(value) for part in parts for value in part]


def belt_of(setup: TrialSetup) -> tuple[float, float, int]:
    """theta in [0, 2 pi), r and d, measured on the way of a straight belt."""
    way = setup.motion.path_world(3)
    middle, along = (way[0] + way[-1]) / 2, way[-1] - way[0]
    theta_rad = math.atan2(middle[1], middle[0]) % (2 * math.pi)
    return (
        theta_rad,
        math.hypot(middle[0], middle[1]),
        int(np.sign(middle[0] * along[1] - middle[1] * along[0])),
    )


def cargo(setup: TrialSetup, target: str, t_s: float):
    """The tray and the object on it, for coal."""
    T_world_tray = setup.motion.pose_at(t_s)
    tray = box_solid(setup.tray_size_m, T_world_tray @ Pose.of((0, 0, -setup.tray_size_m[2] / 2)))
    return tray, object_solid(target, T_world_tray @ setup.T_tray_object)


def test_there_are_the_papers_seven_tasks():
    for kind, task in TASKS.items():
        assert task.model_fields["kind"].default == kind
        assert task.title
    assert len(TASKS) == len({task.title for task in TASKS.values()}) == 7


@pytest.mark.parametrize("kind", TASKS)
def test_the_same_seed_gives_the_same_trial(kind: str):
    task = make(kind)
    assert numbers(drawn(task, 7)) == numbers(drawn(task, 7))
    assert numbers(drawn(task, 7)) != numbers(drawn(task, 8))


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("target", OBJECTS)
@pytest.mark.parametrize("kind", TASKS)
def test_every_object_starts_clear_of_the_arm(kind: str, target: str, robot: str):
    arm = arm_at_home(robot)
    task = make(kind, **ranges(robot))
    for seed in range(3):
        setup = drawn(task, seed, arm, target)
        solids = [*cargo(setup, target, 0.0)]
        solids += [object_solid(name, pose) for name, pose in setup.obstacles]
        if setup.slab is not None:
            solids.append(box_solid(setup.slab.size_m, setup.slab.T_world_box))
        assert not any(sphere.overlaps(solid) for sphere in sphere_solids(arm) for solid in solids)


@pytest.mark.parametrize("target", ["power_drill", "sugar_box"])
@pytest.mark.parametrize("kind", ["sinusoidal", "linear", "circular"])
def test_no_belt_drives_its_cargo_into_the_robots_base(kind: str, target: str):
    base = np.array([(0.0, 0.0, z, 0.055) for z in (0.04, 0.08, 0.12)])
    task = make(kind, distance_min_m=0.15, distance_max_m=0.35)
    for seed in range(6):
        setup = drawn(task, seed, base, target)
        for t_s in np.linspace(0, setup.motion.duration_s, 81):
            solids = cargo(setup, target, t_s)
            assert not any(sphere.overlaps(solid) for sphere in sphere_solids(base) for solid in solids)


@pytest.mark.parametrize("kind", ["linear", "linear_obstacles", "linear_slab", "linear_varying", "linear_z"])
def test_straight_belts_lie_uniformly_around_the_robot(kind: str):
    setups = [drawn(make(kind), seed) for seed in range(300)]
    theta, distance, direction = np.array([belt_of(setup) for setup in setups]).T
    assert stats.kstest(theta, stats.uniform(0, 2 * math.pi).cdf).pvalue > 1e-3
    assert stats.kstest(distance, stats.uniform(0.3, 0.4).cdf).pvalue > 1e-3
    assert stats.binomtest(int((direction > 0).sum()), len(direction)).pvalue > 1e-3


def test_circles_start_uniformly_around_the_robot():
    starts = np.array([drawn(make("circular"), seed).motion.pose_at(0).xyz_m for seed in range(300)])
    theta = np.arctan2(starts[:, 1], starts[:, 0]) % (2 * math.pi)
    assert stats.kstest(theta, stats.uniform(0, 2 * math.pi).cdf).pvalue > 1e-3
    assert stats.kstest(np.hypot(starts[:, 0], starts[:, 1]), stats.uniform(0.3, 0.4).cdf).pvalue > 1e-3


def test_the_object_is_turned_any_way():
    yaw_rad = [drawn(make("linear"), seed).object_yaw_rad for seed in range(300)]
    assert stats.kstest(yaw_rad, stats.uniform(-math.pi, 2 * math.pi).cdf).pvalue > 1e-3


def test_heights_of_the_z_task_are_those_of_the_trays_middle():
    setups = [drawn(make("linear_z"), seed) for seed in range(300)]
    for t_s in (0.0, math.inf):
        middle = [float(s.motion.pose_at(min(t_s, s.motion.duration_s)).xyz_m[2]) - 0.01 for s in setups]
        assert stats.kstest(middle, stats.uniform(0.01, 0.39).cdf).pvalue > 1e-3


@pytest.mark.parametrize("kind", sorted(set(TASKS) - {"linear_z"}))
def test_other_belts_run_on_the_floor(kind: str):
    setup = drawn(make(kind), 3)
    assert setup.tray_size_m[2] == 0.02
    assert np.allclose(setup.motion.path_world(9)[:, 2], 0.02)


@pytest.mark.parametrize(("direction", "sign"), [(1, 1), (-1, -1)])
def test_a_pinned_circle_is_the_papers(direction: int, sign: int):
    task = make("circular", theta_rad=0.5, distance_m=0.4, direction=direction)
    way = drawn(task, 0).motion.path_world(100)
    angle = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    assert math.isclose(angle[0], 0.5)
    assert math.isclose(angle[-1] - angle[0], sign * 1.0 / 0.4)
    assert np.allclose(np.hypot(way[:, 0], way[:, 1]), 0.4)


def test_a_pinned_line_is_the_papers():
    setup = drawn(make("linear", theta_rad=2.0, distance_m=0.5, direction=-1), 0)
    theta_rad, distance_m, direction = belt_of(setup)
    assert math.isclose(theta_rad, 2.0)
    assert math.isclose(distance_m, 0.5)
    assert direction == -1
    assert math.isclose(setup.motion.duration_s, 1.0 / 0.05)


def test_varying_speed_rises_from_the_starts_to_the_ends():
    motion = drawn(make("linear_varying"), 0).motion
    assert isinstance(motion, LinearMotion)
    assert math.isclose(float(np.linalg.norm(motion.velocity_at(0.0))), 0.03)
    assert math.isclose(float(np.linalg.norm(motion.velocity_at(motion.duration_s - 1e-9))), 0.05, rel_tol=1e-6)


def test_the_sinusoid_swings_by_an_eighth_of_the_length():
    setup = drawn(make("sinusoidal", theta_rad=0.0, distance_m=0.5, direction=1), 0)
    way = setup.motion.path_world(2001)
    assert math.isclose(np.ptp(way[:, 0]), 2 / 8, rel_tol=1e-4)
    assert math.isclose(np.ptp(way[:, 1]), 1.0, rel_tol=1e-6)
    crossings = np.count_nonzero(np.diff(np.sign(way[1:-1, 0] - 0.5)) != 0)
    assert crossings == 5


@pytest.mark.parametrize("seed", range(5))
def test_the_slab_hangs_forty_centimetres_above_the_whole_belt(seed: int):
    setup = drawn(make("linear_slab"), seed)
    assert setup.slab is not None
    way = setup.motion.path_world(50)
    T_slab_world = setup.slab.T_world_box.inverse()
    below = T_slab_world.transform_points(way)
    assert setup.slab.size_m == (1.0, 0.10, 0.02)
    assert np.allclose(below[:, 2], -0.40 - 0.01)
    assert np.allclose(below[:, 1], 0.0)
    assert np.allclose(np.abs(below[[0, -1], 0]), 0.5)


@pytest.mark.parametrize("kind", TASKS)
def test_pinning_one_value_leaves_the_others_as_they_were(kind: str):
    for seed in range(5):
        free = drawn(make(kind), seed)
        pinned = drawn(make(kind, direction=1), seed)
        assert pinned.object_yaw_rad == free.object_yaw_rad
        way, pinned_way = free.motion.path_world(2), pinned.motion.path_world(2)
        if kind == "circular":
            assert np.allclose(way[0], pinned_way[0])
        else:
            middle = (way[0] + way[-1]) / 2
            assert np.allclose(middle[:2], ((pinned_way[0] + pinned_way[-1]) / 2)[:2])


def test_all_tasks_take_the_same_from_the_generator():
    following = set[float]()
    for kind in TASKS:
        for pins in ({}, {"theta_rad": 1.0}):
            rng = np.random.default_rng(5)
            make(kind, **pins).draw(rng, load_object("cube"), NO_ARM)
            following.add(rng.random())
    assert len(following) == 1


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("target", ["power_drill", "bleach_cleanser", "tomato_soup_can"])
def test_obstacles_touch_nothing_on_the_way(robot: str, target: str):
    arm = arm_at_home(robot)
    task = make("linear_obstacles", **ranges(robot))
    low = [sphere for sphere, row in zip(sphere_solids(arm), arm, strict=True) if row[2] - row[3] < 0.3]
    for seed in SEEDS:
        setup = drawn(task, seed, arm, target)
        solids = [object_solid(name, pose) for name, pose in setup.obstacles]
        assert [name for name, _ in setup.obstacles] == list(OBSTACLES)
        pairs = [(a, b) for i, a in enumerate(solids) for b in solids[:i]]
        passing = [part for t_s in np.linspace(0, setup.motion.duration_s, 11) for part in cargo(setup, target, t_s)]
        pairs += [(obstacle, other) for obstacle in solids for other in [*passing, *low]]
        assert not any(a.overlaps(b) for a, b in pairs)


def test_coal_sees_an_overlap_where_there_is_one():
    can, drill = "tomato_soup_can", "power_drill"
    on_handle = Pose.of((-0.04, -0.02, 0.0))
    assert object_solid(can, on_handle).overlaps(object_solid(drill, Pose.identity()))
    assert not object_solid(can, Pose.of((0.06, -0.06, 0.0))).overlaps(object_solid(drill, Pose.identity()))
    assert sphere_solids(np.array([[0.0, 0.0, 0.05, 0.01]]))[0].overlaps(object_solid(can, Pose.identity()))


def test_obstacles_stand_in_distinct_subregions_on_the_floor():
    used = set[int]()
    for seed in range(60):
        task = make("linear_obstacles")
        setup = drawn(task, seed)
        theta_rad, distance_m, direction = belt_of(setup)
        belt = DrawnBelt(theta_rad, distance_m, 1 if direction > 0 else -1, 1.0, 0.0, 0.0, 0.0)
        regions = subregions(belt)
        local = [belt.T_world_belt.inverse() @ pose for _, pose in setup.obstacles]
        homes = [
            {i for i, r in enumerate(regions) if r.x_m[0] <= x <= r.x_m[1] and r.y_m[0] <= y <= r.y_m[1]}
            for x, y, _ in (pose.xyz_m for pose in local)
        ]
        assert all(len(home) == 1 for home in homes)
        assert len(set.union(*homes)) == 3
        assert all(0.15 <= abs(pose.xyz_m[1]) <= 0.25 and abs(pose.xyz_m[2]) < 1e-12 for pose in local)
        used |= set.union(*homes)
    assert used == {0, 1, 2, 3, 4}


@pytest.mark.parametrize("direction", [1, -1])
def test_three_subregions_lie_beyond_the_belt_and_two_on_the_robots_side(direction: int):
    belt = DrawnBelt(0.7, 0.5, 1 if direction > 0 else -1, 1.0, 0.0, 0.0, 0.0)
    middles = np.array([(np.mean(region.x_m), np.mean(region.y_m), 0.0) for region in subregions(belt)])
    outwards = belt.T_world_belt.transform_points(middles)[:, :2] @ (math.cos(0.7), math.sin(0.7))
    assert np.allclose(outwards, [0.7, 0.7, 0.7, 0.3, 0.3])


@pytest.mark.parametrize("target", OBJECTS)
def test_the_tray_carries_all_that_the_object_stands_on(target: str):
    for seed in range(10):
        setup = drawn(make("linear"), seed, target=target)
        base = base_points(load_object(target))
        corners = setup.T_tray_object.transform_points(np.column_stack([base, np.zeros(len(base))]))
        half = np.array(setup.tray_size_m[:2]) / 2
        assert (np.abs(corners[:, :2]) <= half - 0.0049).all()
        assert (half >= 0.05).all()


def test_a_trial_that_finds_no_room_says_so():
    everywhere = np.array([[0.0, 0.0, 0.1, 3.0]])
    with pytest.raises(InvalidInputError, match=r"None of 500 belts .*'Linear'.* cube .*0\.3 to 0\.7 m; try larger"):
        drawn(make("linear"), 0, everywhere)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"distance_min_m": 0.8}, "distance_min_m must not exceed distance_max_m"),
        ({"theta_min_rad": 1.0, "theta_max_rad": 0.5}, "theta_min_rad must not exceed theta_max_rad"),
        ({"speed_mps": math.nan}, "finite number"),
        ({"speed_mps": 0.6}, "less than or equal to 0.5"),
        ({"direction": 0}, "should be 1 or -1"),
        ({"sped_mps": 0.1}, "Extra inputs"),
    ],
)
def test_settings_that_make_no_sense_are_refused(settings: dict[str, Any], complaint: str):
    with pytest.raises(ValidationError, match=complaint):
        make("linear", **settings)


def test_heights_must_be_ordered():
    with pytest.raises(ValidationError, match="height_min_m must not exceed height_max_m"):
        make("linear_z", height_min_m=0.4, height_max_m=0.1)


def test_as_many_obstacles_as_asked_for_stand_there():
    for count in range(6):
        task = make("linear_obstacles", obstacles=count)
        assert isinstance(task, LinearObstacles)
        assert len(drawn(task, 1).obstacles) == count


@pytest.mark.parametrize("kind", TASKS)
def test_json_gives_the_same_task(kind: str):
    from backend.tasks import Task

    task = make(kind, theta_rad=1.0)
    assert TypeAdapter[Any](Task).validate_json(task.model_dump_json()) == task
