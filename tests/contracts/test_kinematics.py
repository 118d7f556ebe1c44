"""What the kinematics of every listed robot must satisfy, against pinocchio and PyBullet."""

import importlib
from typing import Any

import numpy as np
import pytest

from backend.kinematics import Kinematics, load_kinematics
from backend.pose import Array, rotation_angle_rad
from backend.robots import ROBOTS
from backend.robots.models import load_model
from backend.sim.bullet import Bullet

pin: Any = importlib.import_module("pinocchio")

POSITION_M = 1e-4
ROTATION_RAD = 8.7e-4
"""0.1 mm and 0.05 degrees."""


@pytest.fixture(params=sorted(ROBOTS))
def arm(request: pytest.FixtureRequest) -> Kinematics:
    return load_kinematics(request.param)


def postures(arm: Kinematics, count: int, seed: int = 0) -> Array:
    """(count, dof) random postures within limits."""
    return np.random.default_rng(seed).uniform(arm.limits[0], arm.limits[1], (count, arm.dof))


def assert_at(arm: Kinematics, q: Array, T: Array) -> None:
    reached = arm.fk(q)
    assert np.linalg.norm(reached[:3, 3] - T[:3, 3]) <= POSITION_M
    assert rotation_angle_rad(reached[:3, :3], T[:3, :3]) <= ROTATION_RAD


def test_tcp_is_where_pybullet_puts_it(arm: Kinematics):
    with Bullet() as bullet:
        home = np.array(arm.description.home_rad)
        robot = bullet.add_robot(load_model(arm.description.name), home, arm.description.gripper.open_rad)
        for q in postures(arm, 1000):
            robot.reset(q, arm.description.gripper.open_rad)
            assert np.abs(robot.tcp().matrix - arm.fk(q)).max() < 1e-6


def test_jacobian_is_pinocchios(arm: Kinematics):
    path = load_model(arm.description.name).collision_urdf
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    flange = model.getFrameId(arm.description.flange_link, pin.FrameType.BODY)
    offset = arm.description.T_flange_tcp
    columns = [model.joints[model.getJointId(name)].idx_v for name in arm.description.arm_joints]
    for q in postures(arm, 50):
        full = pin.neutral(model)
        for name, angle in zip(arm.description.arm_joints, q, strict=True):
            joint = model.joints[model.getJointId(name)]
            value = angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
            full[joint.idx_q : joint.idx_q + joint.nq] = value
        J = pin.computeFrameJacobian(model, data, full, flange, pin.LOCAL_WORLD_ALIGNED)[:, columns]
        arm_m = data.oMf[flange].rotation @ offset.xyz_m
        expected = np.vstack([J[:3] + np.cross(J[3:].T, arm_m).T, J[3:]])
        assert np.allclose(arm.jacobian(q), expected, atol=1e-9)


def test_jacobian_is_the_derivative_of_fk(arm: Kinematics):
    step = 1e-6
    for q in postures(arm, 20):
        J = arm.jacobian(q)
        for j, unit in enumerate(np.eye(arm.dof)):
            ahead, behind = arm.fk(q + step * unit), arm.fk(q - step * unit)
            assert np.allclose((ahead - behind)[:3, 3] / (2 * step), J[:3, j], atol=1e-7)
            spin = (ahead - behind)[:3, :3] @ arm.fk(q)[:3, :3].T / (2 * step)
            assert np.allclose([spin[2, 1], spin[0, 2], spin[1, 0]], J[3:, j], atol=1e-7)


def test_ik_reaches_what_can_be_reached(arm: Kinematics):
    Ts = arm.fk_many(postures(arm, 3000))
    qs, found = arm.ik_many(Ts, np.array(arm.description.home_rad))
    assert found.mean() >= 0.999
    assert np.isnan(qs[~found]).all()
    for q, T in zip(qs[found], Ts[found], strict=True):
        assert (q >= arm.limits[0]).all() and (q <= arm.limits[1]).all()
        assert_at(arm, q, T)


def test_ik_finds_nothing_out_of_reach(arm: Kinematics):
    T = np.eye(4)
    T[:3, 3] = (3.0, 0.0, 0.5)
    home = np.array(arm.description.home_rad)
    assert arm.ik(T, home) is None
    assert arm.ik_branches(T, home).shape == (0, arm.dof)
    assert not arm.ik_many(T[None], home)[1].any()


def test_ik_goes_on_from_its_seed(arm: Kinematics):
    rng = np.random.default_rng(1)
    near = 0
    for q in postures(arm, 300):
        seed = q + rng.normal(scale=0.02, size=arm.dof)
        found = arm.ik(arm.fk(q), seed)
        if found is not None:
            assert_at(arm, found, arm.fk(q))
            near += bool(np.abs(found - seed).max() < 0.3)
    assert near >= 285


def test_branches_are_distinct_sorted_and_near(arm: Kinematics):
    q_near = np.array(arm.description.home_rad)
    counts: list[int] = []
    for q in postures(arm, 60):
        T = arm.fk(q)
        branches = arm.ik_branches(T, q_near)
        counts.append(len(branches))
        distances = np.linalg.norm(branches - q_near, axis=1)
        assert (np.diff(distances) >= 0.0).all()
        for i, branch in enumerate(branches):
            assert_at(arm, branch, T)
            for other in branches[:i]:
                assert np.abs(branch - other).max() > 0.01
            for turn in (-2 * np.pi, 2 * np.pi):
                inside = (branch + turn >= arm.limits[0]) & (branch + turn <= arm.limits[1])
                assert (np.abs(branch + turn - q_near) >= np.abs(branch - q_near) - 1e-9)[inside].all()
    assert min(counts) >= 1 and np.mean(counts) > 4.0


def test_following_a_line_never_jumps(arm: Kinematics):
    q = np.array(arm.description.home_rad)
    Ts = np.repeat(arm.fk(q)[None], 60, axis=0)
    Ts[:, 2, 3] += np.linspace(0.0, 0.06, 60)
    qs = arm.follow(Ts, q, 0.1)
    assert qs is not None
    assert np.abs(np.diff(qs, axis=0)).max() <= 0.1
    for q_i, T in zip(qs, Ts, strict=True):
        assert_at(arm, q_i, T)
    Ts[30:, 0, 3] += 5.0
    assert arm.follow(Ts, q, 0.1) is None


def test_ik_answers_the_same_every_time(arm: Kinematics):
    Ts = arm.fk_many(postures(arm, 50))
    home = np.array(arm.description.home_rad)
    first = arm.ik_many(Ts, home)[0]
    arm.ik_branches(Ts[3], home)
    assert np.array_equal(first, arm.ik_many(Ts, home)[0], equal_nan=True)


def test_spheres_ride_on_their_links(arm: Kinematics):
    q = postures(arm, 1)[0]
    model = load_model(arm.description.name)
    joints = dict(zip(arm.description.arm_joints, q.tolist(), strict=True))
    poses = arm.tree.link_poses(joints)
    world = arm.spheres_world(q)
    for name, (_, start, stop) in zip(arm.spheres.names, arm.spheres.index, strict=True):
        local = model.spheres[name]
        if name not in arm.description.gripper.hand_links:
            expected = local[:, :3] @ poses[name][:3, :3].T + poses[name][:3, 3]
            assert np.allclose(world[start:stop, :3], expected, atol=1e-9)
        assert np.array_equal(world[start:stop, 3], local[:, 3])


def test_closing_the_hand_moves_only_its_fingers(arm: Kinematics):
    q, gripper = np.array(arm.description.home_rad), arm.description.gripper
    open_hand, closed = arm.spheres_world(q), arm.spheres_world(q, gripper.closed_rad)
    moved = np.abs(open_hand - closed).max(axis=1) > 1e-6
    links = {
        name
        for name, (_, start, stop) in zip(arm.spheres.names, arm.spheres.index, strict=True)
        if moved[start:stop].any()
    }
    assert links and links <= set(gripper.finger_links)
