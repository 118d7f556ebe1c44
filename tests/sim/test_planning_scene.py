"""PlanningScene against PyBullet's distances on the collision hulls."""

import itertools
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh

from backend.errors import InvalidInputError
from backend.kinematics import load_kinematics
from backend.kinematics.spheres import hand_joints
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.robots.models import load_model
from backend.sim.bullet import Bullet, Robot
from backend.sim.planning_scene import PlanningScene

TRAY_M = (0.2, 0.2, 0.02)
STATES = 1200


@dataclass(frozen=True)
class Twin:
    """The same surroundings, as the planner believes them and in PyBullet."""

    scene: PlanningScene
    bullet: Bullet
    robot: Robot
    hulls: dict[str, Array]
    bodies: tuple[int, ...]


@pytest.fixture(params=sorted(ROBOTS), scope="module")
def twin(request: pytest.FixtureRequest) -> Iterator[Twin]:
    kinematics = load_kinematics(request.param)
    description = kinematics.description
    scene = PlanningScene(kinematics)
    obstacles = [
        (name, Pose.from_xyz_yaw((x, y, 0.0), 0.7))
        for name, x, y in (
            ("tomato_soup_can", 0.35, -0.3),
            ("power_drill", -0.3, 0.35),
            ("bleach_cleanser", 0.1, 0.5),
        )
    ]
    slab, T_slab = (0.1, 1.0, 0.02), Pose.of((-0.5, 0.0, 0.42))
    T_tray = Pose.of((0.5, 0.05, 0.05))
    target = load_object("mustard_bottle")
    with Bullet() as bullet:
        robot = bullet.add_robot(
            load_model(request.param), np.array(description.home_rad), description.gripper.open_rad
        )
        bodies: list[int] = []
        for name, pose in obstacles:
            scene.add_object(load_object(name), pose)
            bodies.append(bullet.add_object(load_object(name), pose, fixed=True))
        scene.add_box(slab, T_slab)
        bodies.append(bullet.add_box(slab, T_slab))
        scene.set_target(target, T_tray, TRAY_M, T_tray)
        bodies.append(bullet.add_object(target, T_tray, fixed=True))
        bodies.append(bullet.add_box(TRAY_M, T_tray @ Pose.of((0.0, 0.0, -TRAY_M[2] / 2))))
        yield Twin(scene, bullet, robot, hulls(robot.model.collision_urdf), tuple(bodies))


def postures(scene: PlanningScene, count: int, seed: int) -> Array:
    limits = scene.kinematics.limits
    return np.random.default_rng(seed).uniform(limits[0], limits[1], (count, scene.kinematics.dof))


def hulls(path: Path) -> dict[str, Array]:
    """Link -> (n, 3) vertices of its collision meshes in the link frame; boxes are inside the spheres anyway."""
    found: dict[str, list[Array]] = {}
    for link in ET.parse(path).getroot().findall("link"):
        for mesh in link.iterfind("collision/geometry/mesh"):
            points = trimesh.load_mesh(path.parent / str(mesh.get("filename"))).vertices
            found.setdefault(str(link.get("name")), []).append(np.asarray(points))
    return {name: np.concatenate(parts) for name, parts in found.items()}


def truth_m(twin: Twin, q: Array, within_m: float) -> float:
    """Least true distance, at most ``within_m``; what stands on the floor and only turns does not count there."""
    kinematics = twin.scene.kinematics
    opening = kinematics.description.gripper.open_rad
    twin.robot.reset(q, opening)
    joints = dict(zip(kinematics.description.arm_joints, q.tolist(), strict=True))
    poses = kinematics.tree.link_poses(joints | hand_joints(kinematics.description.gripper, opening))
    base = {name for name, body in kinematics.chain.body_of_link.items() if body <= 1}
    lowest = min(
        float((points @ poses[link][2, :3] + poses[link][2, 3]).min())
        for link, points in twin.hulls.items()
        if link not in base
    )
    distances = [twin.bullet.closest_distance_m(twin.robot.body, body, within_m) for body in twin.bodies]
    return min([within_m, lowest, *(d for d in distances if d is not None)])


def test_home_is_free(twin: Twin):
    home = np.array(twin.scene.kinematics.description.home_rad)
    assert twin.scene.why_blocked(home) == ""
    assert twin.scene.is_free(home)
    assert twin.scene.clearance_m(home) > 0.0


def test_nothing_called_free_touches(twin: Twin):
    qs = postures(twin.scene, STATES, seed=1)
    free = qs[twin.scene.free_many(qs)]
    assert len(free) > STATES // 10
    for q in free:
        assert truth_m(twin, q, 0.01) > 0.0, twin.scene.clearance_m(q)
        assert not twin.robot.self_contacts()


def test_few_postures_with_room_are_called_blocked(twin: Twin):
    room_m = 0.025
    qs = postures(twin.scene, STATES, seed=2)
    blocked = ~twin.scene.free_many(qs)
    roomy = np.array([truth_m(twin, q, room_m) >= room_m and not twin.robot.self_contacts(room_m) for q in qs])
    assert roomy.sum() > STATES // 20
    assert (blocked & roomy).sum() <= 0.05 * roomy.sum()


def test_clearance_never_exceeds_the_true_distance(twin: Twin):
    for q in postures(twin.scene, 150, seed=3):
        if twin.scene.is_free(q):
            assert twin.scene.clearance_m(q) <= truth_m(twin, q, 1.0) + 1e-3


def test_one_and_many_agree_and_reasons_are_given_exactly_when_blocked(twin: Twin):
    qs = postures(twin.scene, 300, seed=4)
    many = twin.scene.free_many(qs)
    assert [twin.scene.is_free(q) for q in qs] == many.tolist()
    assert [twin.scene.why_blocked(q) == "" for q in qs] == many.tolist()


def test_an_edge_is_free_when_all_its_postures_are(twin: Twin):
    qs = postures(twin.scene, 120, seed=5)
    qs = qs[twin.scene.free_many(qs)]
    for a, b in itertools.pairwise(qs):
        steps = int(np.ceil(np.abs(b - a).max() / 0.02))
        between = a + np.linspace(0.0, 1.0, steps + 1)[1:, None] * (b - a)
        assert twin.scene.edge_free(a, b, 0.02) == twin.scene.free_many(between).all()


def with_target(robot: str = "ur5_robotiq") -> tuple[PlanningScene, Array]:
    """A scene with a bottle where the hand is, and the posture of the arm."""
    kinematics = load_kinematics(robot)
    scene = PlanningScene(kinematics)
    q = np.array(kinematics.description.home_rad)
    T_world_tcp = kinematics.fk(q)
    palm = T_world_tcp[:3, 3] - 0.06 * T_world_tcp[:3, 2]
    T_object = Pose.of(palm) @ Pose.of((0.0, 0.0, -0.12))
    scene.set_target(load_object("bleach_cleanser"), T_object, TRAY_M, Pose.of((0.8, 0.8, 0.1)))
    return scene, q


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_the_hand_may_touch_the_target_only_when_allowed(robot: str):
    scene, q = with_target(robot)
    assert not scene.is_free(q)
    assert "too near to the bleach_cleanser" in scene.why_blocked(q)
    assert scene.is_free(q, target=False)
    assert scene.is_free(q, hand_may_touch_target=True)


def test_moving_the_target_moves_its_tray():
    scene, q = with_target()
    scene.move_target(Pose.of((2.0, 2.0, 0.5)))
    assert scene.is_free(q)
    T_world_tcp = scene.kinematics.fk(q)
    palm = T_world_tcp[:3, 3] - 0.06 * T_world_tcp[:3, 2]
    scene.move_target(Pose.of(2.0 * palm - (0.8, 0.8, 0.1 + 0.12)))
    assert "too near to the tray" in scene.why_blocked(q, target=False)


def test_the_first_contact_with_a_moving_target_is_that_of_moving_it_step_by_step():
    scene, home = with_target()
    rng = np.random.default_rng(6)
    found = set[str]()
    for _ in range(200):
        qs = np.array([home + 0.3 * rng.normal(size=home.size), home, home + 0.3 * rng.normal(size=home.size)])
        at = [Pose.from_xyz_yaw(rng.uniform((-0.9, -0.9, 0.0), (0.9, 0.9, 0.9)), rng.uniform(-3.0, 3.0)) for _ in qs]
        told = scene.first_contact(qs, np.array([pose.matrix for pose in at]))
        one_by_one = list[str]()
        for q, pose in zip(qs, at, strict=True):
            scene.move_target(pose)
            one_by_one.append(scene.why_blocked(q))
        first = next((i for i, why in enumerate(one_by_one) if why), None)
        assert told == (None if first is None else (first, one_by_one[first]))
        found.add("" if told is None else told[1].rpartition(" ")[2])
    assert {"", "bleach_cleanser", "tray"} <= found


def test_what_is_in_the_hand_leaves_its_tray_behind():
    scene, q = with_target()
    T_world_tcp = scene.kinematics.fk(q)
    held = T_world_tcp[:3, 3] - 0.06 * T_world_tcp[:3, 2] - (0.0, 0.0, 0.12)
    tray_from_object = np.array([0.8, 0.8, 0.1]) - held

    def contact(left: Array, *, in_hand: bool = True) -> str:
        Ts = [Pose.of(at).matrix[None] for at in (held, left)]
        return (scene.first_contact(q[None], *Ts, in_hand=in_hand) or (0, ""))[1]

    assert contact(np.array([5.0, 5.0, 0.5])) == ""
    assert contact(np.array([5.0, 5.0, 0.5]), in_hand=False).endswith("too near to the bleach_cleanser")
    assert contact(T_world_tcp[:3, 3] - tray_from_object).endswith("too near to the tray")


def test_a_moved_obstacle_is_where_it_was_put():
    kinematics = load_kinematics("mico")
    scene = PlanningScene(kinematics)
    q = np.array(kinematics.description.home_rad)
    index = scene.add_box((0.1, 0.1, 0.1), Pose.of((2.0, 0.0, 0.5)))
    assert scene.is_free(q)
    scene.move_obstacle(index, Pose.of(kinematics.fk(q)[:3, 3]))
    assert "too near to the slab" in scene.why_blocked(q)
    with pytest.raises(InvalidInputError, match="no obstacle 1 in the planning scene; it has 1"):
        scene.move_obstacle(1, Pose.identity())


def test_a_scene_has_one_target():
    scene, _ = with_target()
    with pytest.raises(InvalidInputError, match="has a target already"):
        scene.set_target(load_object("cube"), Pose.identity(), TRAY_M, Pose.identity())
    with pytest.raises(InvalidInputError, match="has no target yet"):
        PlanningScene(load_kinematics("mico")).move_target(Pose.identity())
