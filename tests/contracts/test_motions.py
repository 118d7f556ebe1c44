"""Every motion: pure, continuous, its velocity the derivative of its pose, its length what it claims."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pydantic import TypeAdapter, ValidationError
from scipy.integrate import quad

from backend.motions import CircularMotion, LinearMotion, Motion, SinusoidalMotion

coordinates = st.floats(-1.0, 1.0)
speeds = st.floats(0.005, 0.5)
heights = st.floats(0.02, 0.5)
angles = st.floats(-math.pi, math.pi)
lengths = st.floats(0.2, 2.0)
shares = st.floats(0.0, 1.0)


def ends(x: float, y: float, z0: float, z1: float, yaw_rad: float, length_m: float):
    return (x, y, z0), (x + length_m * math.cos(yaw_rad), y + length_m * math.sin(yaw_rad), z1)


def make_linear(x: float, y: float, z: float, z1: float, yaw: float, length: float, v0: float, v1: float):
    start, end = ends(x, y, z, z1, yaw, length)
    return LinearMotion(start_m=start, end_m=end, start_speed_mps=v0, end_speed_mps=v1)


def make_sinusoidal(x: float, y: float, z: float, yaw: float, length: float, v: float):
    start, end = ends(x, y, z, z, yaw, length)
    return SinusoidalMotion(start_m=start, end_m=end, speed_mps=v, amplitude_m=length / 8, period_m=length / 3)


linears = st.builds(make_linear, coordinates, coordinates, heights, heights, angles, lengths, speeds, speeds)
sinusoids = st.builds(make_sinusoidal, coordinates, coordinates, heights, angles, lengths, speeds)
circles = st.builds(
    CircularMotion,
    center_m=st.tuples(coordinates, coordinates, heights),
    radius_m=st.floats(0.15, 0.7),
    start_angle_rad=angles,
    direction=st.sampled_from([1, -1]),
    length_m=lengths,
    speed_mps=speeds,
)
motions = linears | circles | sinusoids


def top_speed_mps(motion: Motion) -> float:
    match motion:
        case LinearMotion():
            return max(motion.start_speed_mps, motion.end_speed_mps)
        case CircularMotion():
            return motion.speed_mps
        case SinusoidalMotion():
            steepest = 2 * math.pi * motion.amplitude_m / motion.period_m
            return motion.speed_mps * math.hypot(1.0, steepest)


def travelled_m(motion: Motion) -> float:
    return float(np.linalg.norm(np.diff(motion.path_world(2001), axis=0), axis=1).sum())


@given(motions, st.lists(shares, min_size=1, max_size=5))
def test_a_motion_is_a_pure_function_of_time(motion: Motion, at: list[float]):
    times_s = [share * motion.duration_s for share in at]
    first = [motion.pose_at(t).matrix for t in times_s]
    again = [motion.pose_at(t).matrix for t in reversed(times_s)][::-1]
    assert_allclose(first, again, atol=0)


@given(motions, shares, st.floats(0.0, 1.0))
def test_it_never_moves_faster_than_its_top_speed(motion: Motion, share: float, gap_s: float):
    t_s = share * motion.duration_s
    moved_m = np.linalg.norm(motion.pose_at(t_s + gap_s).xyz_m - motion.pose_at(t_s).xyz_m)
    assert moved_m <= top_speed_mps(motion) * gap_s * (1 + 1e-9) + 1e-12


@given(motions, st.floats(0.01, 0.99))
def test_velocity_is_the_derivative_of_position(motion: Motion, share: float):
    t_s, h_s = share * motion.duration_s, 1e-4 * motion.duration_s
    slope = (motion.pose_at(t_s + h_s).xyz_m - motion.pose_at(t_s - h_s).xyz_m) / (2 * h_s)
    assert_allclose(motion.velocity_at(t_s), slope, atol=1e-5 * top_speed_mps(motion))


@given(motions, st.floats(1e-6, 100.0))
def test_before_and_after_the_tray_stands_at_the_ends(motion: Motion, beyond_s: float):
    for outside_s, end_s in ((-beyond_s, 0.0), (motion.duration_s + beyond_s, motion.duration_s)):
        assert_allclose(motion.pose_at(outside_s).matrix, motion.pose_at(end_s).matrix, atol=0)
        assert not motion.velocity_at(outside_s).any()


@given(motions)
def test_it_moves_from_the_first_moment(motion: Motion):
    assert np.linalg.norm(motion.velocity_at(0.0)) > 0


@given(motions, shares)
def test_the_tray_stays_level_and_keeps_facing_the_way_it_started(motion: Motion, share: float):
    pose = motion.pose_at(share * motion.duration_s)
    assert_allclose(pose.rotation[:, 2], [0, 0, 1], atol=1e-12)
    assert math.isclose(math.cos(pose.yaw_rad - motion.yaw_rad), 1.0, abs_tol=1e-12)
    if not isinstance(motion, SinusoidalMotion):
        vx, vy, _ = motion.velocity_at(0.0)
        assert math.isclose(math.cos(math.atan2(vy, vx) - motion.yaw_rad), 1.0, abs_tol=1e-9)


@given(motions)
def test_the_path_runs_from_start_to_end(motion: Motion):
    path = motion.path_world(7)
    assert path.shape == (7, 3)
    assert_allclose(path[0], motion.pose_at(0.0).xyz_m)
    assert_allclose(path[-1], motion.pose_at(motion.duration_s).xyz_m)


@settings(max_examples=30)
@given(linears | circles)
def test_linear_and_circular_motions_are_as_long_as_they_say(motion: LinearMotion | CircularMotion):
    assert math.isclose(travelled_m(motion), motion.length_m, rel_tol=1e-5)


@given(linears)
def test_linear_motion_goes_from_end_to_end_with_even_acceleration(motion: LinearMotion):
    assert_allclose(motion.pose_at(motion.duration_s).xyz_m, motion.end_m, atol=1e-9)
    speed = [np.linalg.norm(motion.velocity_at(share * motion.duration_s)) for share in (0.0, 0.5, 1 - 1e-12)]
    assert_allclose(speed[0], motion.start_speed_mps)
    assert_allclose(speed[1], (motion.start_speed_mps + motion.end_speed_mps) / 2)
    assert_allclose(speed[2], motion.end_speed_mps)


@given(circles, shares)
def test_circular_motion_stays_on_its_circle_and_goes_its_way_round(motion: CircularMotion, share: float):
    t_s = share * motion.duration_s
    arm = motion.pose_at(t_s).xyz_m - np.array(motion.center_m)
    assert math.isclose(float(np.hypot(arm[0], arm[1])), motion.radius_m)
    assert math.isclose(arm[2], 0.0, abs_tol=1e-12)
    if share < 1.0:
        velocity = motion.velocity_at(t_s)
        assert math.isclose(float(np.linalg.norm(velocity)), motion.speed_mps)
        assert np.sign(arm[0] * velocity[1] - arm[1] * velocity[0]) == motion.direction


@given(circles)
def test_circular_motion_starts_at_its_angle(motion: CircularMotion):
    arm = motion.pose_at(0.0).xyz_m - np.array(motion.center_m)
    assert math.isclose(math.cos(math.atan2(arm[1], arm[0]) - motion.start_angle_rad), 1.0, abs_tol=1e-12)


@given(sinusoids, shares)
def test_sinusoidal_motion_is_a_sine_across_its_axis(motion: SinusoidalMotion, share: float):
    start, end = np.array(motion.start_m), np.array(motion.end_m)
    ahead = (end - start) / np.linalg.norm(end - start)
    left = np.array([-ahead[1], ahead[0], 0.0])
    offset = motion.pose_at(share * motion.duration_s).xyz_m - start
    progress_m = share * motion.length_m
    assert math.isclose(float(offset @ ahead), progress_m, abs_tol=1e-9)
    expected = motion.length_m / 8 * math.sin(3 * 2 * math.pi * share)
    assert math.isclose(float(offset @ left), expected, abs_tol=1e-9)


@settings(max_examples=30)
@given(sinusoids)
def test_sinusoidal_motion_is_as_long_as_its_arc_integral(motion: SinusoidalMotion):
    k = 2 * math.pi / motion.period_m

    def slope(s: float) -> float:
        return math.hypot(1.0, motion.amplitude_m * k * math.cos(k * s))

    arc_m = quad(slope, 0, motion.length_m)[0]
    assert math.isclose(travelled_m(motion), arc_m, rel_tol=1e-5)


def test_the_papers_sinusoid_runs_at_one_to_two_point_six_times_its_axis_speed():
    motion = make_sinusoidal(0.3, -0.5, 0.02, 1.0, 1.0, 0.01)
    speed = [np.linalg.norm(motion.velocity_at(t)) for t in np.linspace(0, motion.duration_s, 2000)[:-1]]
    assert math.isclose(min(speed) / 0.01, 1.0, abs_tol=0.01)
    assert math.isclose(max(speed) / 0.01, 2.56, abs_tol=0.01)


@given(motions)
def test_json_gives_the_same_motion(motion: Motion):
    assert TypeAdapter[Motion](Motion).validate_json(json.dumps(motion.model_dump())) == motion


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_not_a_number_is_refused(value: float):
    with pytest.raises(ValidationError, match="finite number"):
        LinearMotion(start_m=(0, value, 0), end_m=(1, 0, 0), start_speed_mps=0.1, end_speed_mps=0.1)


def test_a_line_needs_a_heading():
    with pytest.raises(ValidationError, match="must differ in x or y"):
        LinearMotion(start_m=(0, 0, 0), end_m=(0, 0, 1), start_speed_mps=0.1, end_speed_mps=0.1)


def test_a_sinusoid_must_be_level():
    with pytest.raises(ValidationError, match="and not in z"):
        SinusoidalMotion(start_m=(0, 0, 0), end_m=(1, 0, 1), speed_mps=0.1, amplitude_m=0.1, period_m=0.3)
