"""Poses obey the group's laws; trajectories pass through their knots and stand still outside."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from backend.pose import (
    Array,
    Pose,
    inverse,
    rotation_angle_rad,
    rotation_from_rpy,
    rotation_from_wxyz,
    wxyz_from_rotation,
)
from backend.trajectory import Path, Trajectory

metres = st.floats(-10.0, 10.0)
angles = st.floats(-math.pi, math.pi)
triples = st.tuples(metres, metres, metres)
rpys = st.tuples(angles, angles, angles)
poses = st.builds(Pose.from_xyz_rpy, triples, rpys)
quaternions = st.tuples(*[st.floats(-1.0, 1.0)] * 4).map(np.array).filter(lambda q: float(np.linalg.norm(q)) > 1e-3)
seeds = st.integers(0, 2**32 - 1)


@given(poses)
def test_inverse_undoes(pose: Pose):
    assert_allclose((pose @ pose.inverse()).matrix, np.eye(4), atol=1e-9)
    assert_allclose((pose.inverse() @ pose).matrix, np.eye(4), atol=1e-9)


@given(poses, poses, poses)
def test_products_associate(a: Pose, b: Pose, c: Pose):
    assert_allclose(((a @ b) @ c).matrix, (a @ (b @ c)).matrix, atol=1e-9)


@given(poses, poses, triples)
def test_a_product_moves_points_as_its_factors_in_turn(a: Pose, b: Pose, point: tuple[float, float, float]):
    points = np.array([point])
    assert_allclose((a @ b).transform_points(points), a.transform_points(b.transform_points(points)), atol=1e-9)


@given(poses)
def test_a_pose_is_its_position_and_quaternion(pose: Pose):
    assert_allclose(Pose.of(pose.xyz_m, pose.wxyz).matrix, pose.matrix, atol=1e-9)
    assert pose.wxyz[0] >= 0
    assert math.isclose(float(np.linalg.norm(pose.wxyz)), 1.0, abs_tol=1e-9)


@given(quaternions)
def test_rotation_of_a_quaternion_agrees_with_scipy(wxyz: Array):
    w, x, y, z = wxyz
    assert_allclose(rotation_from_wxyz(wxyz), Rotation.from_quat([x, y, z, w]).as_matrix(), atol=1e-9)


@given(quaternions)
def test_quaternion_of_a_rotation_agrees_with_scipy(wxyz: Array):
    rotation = rotation_from_wxyz(wxyz)
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    ours, theirs = wxyz_from_rotation(rotation), np.array([w, x, y, z])
    assert math.isclose(abs(float(ours @ theirs)), 1.0, abs_tol=1e-9)


@given(rpys)
def test_roll_pitch_yaw_are_about_fixed_axes(rpy: tuple[float, float, float]):
    assert_allclose(rotation_from_rpy(np.array(rpy)), Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-9)


@given(triples, angles)
def test_yaw_is_read_back(xyz: tuple[float, float, float], yaw_rad: float):
    difference = Pose.from_xyz_yaw(xyz, yaw_rad).yaw_rad - yaw_rad
    assert math.isclose(math.cos(difference), 1.0, abs_tol=1e-12)


@given(poses, poses)
def test_rotation_angle_agrees_with_scipy(a: Pose, b: Pose):
    expected = float(Rotation.from_matrix(a.rotation.T @ b.rotation).magnitude())
    assert math.isclose(rotation_angle_rad(a.rotation, b.rotation), expected, abs_tol=1e-6)


@given(st.lists(poses, min_size=1, max_size=5))
def test_many_inverses_are_each_ones_inverse(several: list[Pose]):
    stacked = inverse(np.stack([pose.matrix for pose in several]))
    assert_allclose(stacked, np.stack([pose.inverse().matrix for pose in several]), atol=1e-12)


def test_nobody_can_write_to_a_pose():
    matrix = np.eye(4)
    pose = Pose(matrix)
    matrix[0, 3] = 5.0
    assert pose.xyz_m[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        pose.matrix[0, 3] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        pose.xyz_m[0] = 1.0


@pytest.mark.parametrize("matrix", [np.eye(3), np.full((4, 4), np.nan), np.diag([1.0, 1.0, np.inf, 1.0])])
def test_what_is_no_finite_4x4_matrix_is_refused(matrix: Array):
    with pytest.raises(ValueError, match="A pose is a finite 4x4 matrix"):
        Pose(matrix)


def some_trajectory(seed: int) -> Trajectory:
    rng = np.random.default_rng(seed)
    n, dof = int(rng.integers(2, 12)), int(rng.integers(1, 8))
    t_s = rng.uniform(-5.0, 5.0) + np.cumsum(rng.uniform(0.01, 1.0, n))
    return Trajectory(t_s, rng.normal(size=(n, dof)), rng.normal(size=(n, dof)))


@given(seeds)
def test_a_trajectory_passes_through_its_knots(seed: int):
    trajectory = some_trajectory(seed)
    for t_s, q, qd in list(zip(trajectory.t_s, trajectory.q, trajectory.qd, strict=True))[:-1]:
        sampled_q, sampled_qd = trajectory.sample(float(t_s))
        assert_allclose(sampled_q, q, atol=1e-9)
        assert_allclose(sampled_qd, qd, atol=1e-9)


@given(seeds, st.floats(0.0, 0.999))
def test_a_trajectory_is_the_cubic_hermite_spline(seed: int, share: float):
    trajectory = some_trajectory(seed)
    spline = CubicHermiteSpline(trajectory.t_s, trajectory.q, trajectory.qd)
    t_s = trajectory.start_s + share * (trajectory.end_s - trajectory.start_s)
    q, qd = trajectory.sample(t_s)
    assert_allclose(q, spline(t_s), atol=1e-8)
    assert_allclose(qd, spline(t_s, 1), atol=1e-6)


@given(seeds, st.floats(1e-6, 100.0))
def test_a_trajectory_stands_still_at_its_ends(seed: int, beyond_s: float):
    trajectory = some_trajectory(seed)
    for t_s, q in (
        (trajectory.start_s - beyond_s, trajectory.q[0]),
        (trajectory.end_s + beyond_s, trajectory.q[-1]),
    ):
        sampled_q, sampled_qd = trajectory.sample(t_s)
        assert_allclose(sampled_q, q)
        assert not sampled_qd.any()


@given(seeds, st.floats(-50.0, 50.0), st.floats(0.0, 1.0))
def test_a_shifted_trajectory_is_the_same_motion_later(seed: int, by_s: float, share: float):
    trajectory = some_trajectory(seed)
    t_s = trajectory.start_s + share * (trajectory.end_s - trajectory.start_s)
    assert_allclose(trajectory.shifted(by_s).sample(t_s + by_s)[0], trajectory.sample(t_s)[0], atol=1e-6)


@given(seeds)
def test_holding_is_standing_still(seed: int):
    q = np.random.default_rng(seed).normal(size=6)
    hold = Trajectory.hold(q, 3.0)
    for t_s in (0.0, 3.0, 3.0005, 9.0):
        sampled_q, sampled_qd = hold.sample(t_s)
        assert_allclose(sampled_q, q)
        assert not sampled_qd.any()


@given(seeds)
def test_a_path_is_at_least_as_long_as_the_way_between_its_ends(seed: int):
    waypoints = np.random.default_rng(seed).normal(size=(5, 6))
    direct = float(np.linalg.norm(waypoints[-1] - waypoints[0]))
    assert Path(waypoints).length_rad >= direct - 1e-12
    assert math.isclose(Path(waypoints[[0, -1]]).length_rad, direct)
