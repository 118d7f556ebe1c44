"""Every predictor: exact on a still object, never sees the future, takes dropouts; good ones follow a belt."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from backend.methods.method import ConstantVelocity, Kalman, LastPose, Lstm, Oracle, PredictorConfig
from backend.motions import CircularMotion, LinearMotion
from backend.pipeline.predict import Predictor, make_predictor
from backend.pipeline.predict.lstm import along, curve
from backend.pipeline.predict.window import HORIZONS_S
from backend.pipeline.values import Observation
from backend.pose import Pose

CAUSAL: list[PredictorConfig] = [ConstantVelocity(), Kalman(), Lstm(), LastPose()]
LINE = LinearMotion(start_m=(0.4, -0.5, 0.02), end_m=(0.4, 0.5, 0.02), start_speed_mps=0.05, end_speed_mps=0.05)
CIRCLE = CircularMotion(
    center_m=(0.0, 0.0, 0.02), radius_m=0.4, start_angle_rad=0.3, direction=1, length_m=1.0, speed_mps=0.03
)
BEND = CircularMotion(
    center_m=(0.0, 0.0, 0.02), radius_m=0.3, start_angle_rad=0.3, direction=-1, length_m=1.0, speed_mps=0.03
)


def observation(t_s: float, pose: Pose | None) -> Observation:
    return Observation(t_s, np.zeros(6), np.zeros(6), pose)


def forbidden(t_s: float) -> Pose:
    raise AssertionError("a causal predictor asked for the truth")


def watched(config: PredictorConfig, motion: LinearMotion | CircularMotion, until_s: float, noise_m: float = 0.0):
    predictor = make_predictor(config, forbidden)
    rng = np.random.default_rng(0)
    for t_s in np.arange(0.0, until_s + 1e-9, 0.05):
        pose = motion.pose_at(float(t_s))
        seen = Pose.of(pose.xyz_m + noise_m * rng.standard_normal(3), pose.wxyz)
        predictor.observe(observation(float(t_s), seen))
    return predictor


def error_m(predictor: Predictor, motion: LinearMotion | CircularMotion, t_s: float) -> float:
    prediction = predictor.predict(np.array([t_s]))
    assert prediction is not None
    return float(np.linalg.norm(prediction.Ts_world_object[0, :3, 3] - motion.pose_at(t_s).xyz_m))


@pytest.mark.parametrize("config", CAUSAL, ids=lambda c: c.kind)
def test_a_still_object_is_predicted_exactly(config: PredictorConfig):
    pose = Pose.from_xyz_rpy((0.3, -0.2, 0.1), (0.02, -0.01, 3.1))
    predictor = make_predictor(config, forbidden)
    for k in range(20):
        predictor.observe(observation(0.05 * k, pose))
    prediction = predictor.predict(np.array([1.0, 3.0]))
    assert prediction is not None
    np.testing.assert_allclose(prediction.Ts_world_object, [pose.matrix, pose.matrix], atol=1e-9)
    np.testing.assert_allclose(prediction.velocity_mps, 0.0, atol=1e-9)


@pytest.mark.parametrize("config", CAUSAL, ids=lambda c: c.kind)
def test_nothing_is_predicted_before_the_first_detection(config: PredictorConfig):
    predictor = make_predictor(config, forbidden)
    predictor.observe(observation(0.0, None))
    assert predictor.predict(np.array([1.0])) is None


@pytest.mark.parametrize("config", CAUSAL, ids=lambda c: c.kind)
def test_a_dropout_changes_nothing_but_what_it_hides(config: PredictorConfig):
    with_gap, without = make_predictor(config, forbidden), make_predictor(config, forbidden)
    for k in range(30):
        pose = LINE.pose_at(0.05 * k)
        with_gap.observe(observation(0.05 * k, pose))
        without.observe(observation(0.05 * k, pose))
        with_gap.observe(observation(0.05 * k + 0.01, None))
    a, b = with_gap.predict(np.array([2.0])), without.predict(np.array([2.0]))
    assert a is not None and b is not None
    np.testing.assert_array_equal(a.Ts_world_object, b.Ts_world_object)


@pytest.mark.parametrize("config", [ConstantVelocity(), Kalman(), Lstm()], ids=lambda c: c.kind)
def test_a_straight_belt_is_followed(config: PredictorConfig):
    assert error_m(watched(config, LINE, 2.0), LINE, 4.0) < 2e-3


@pytest.mark.parametrize("config", [ConstantVelocity(), Kalman(), Lstm()], ids=lambda c: c.kind)
def test_prediction_beats_none_on_a_circle(config: PredictorConfig):
    assert error_m(watched(config, CIRCLE, 3.0), CIRCLE, 4.0) < 0.2 * error_m(
        watched(LastPose(), CIRCLE, 3.0), CIRCLE, 4.0
    )


def test_kalman_smooths_noise_better_than_two_points_would():
    noisy = watched(Kalman(measurement_std_m=0.005), LINE, 4.0, noise_m=0.005)
    assert error_m(noisy, LINE, 5.0) < 0.01


@pytest.mark.parametrize("config", [ConstantVelocity(), Kalman(), Lstm()], ids=lambda c: c.kind)
def test_a_yaw_that_passes_half_a_turn_does_not_jump(config: PredictorConfig):
    predictor = make_predictor(config, forbidden)
    for k in range(40):
        predictor.observe(observation(0.05 * k, Pose.from_xyz_yaw((0.3, 0.0, 0.02), 2.9 + 0.3 * 0.05 * k)))
    prediction = predictor.predict(np.array([2.95]))
    assert prediction is not None
    expected = Pose.from_xyz_yaw((0.3, 0.0, 0.02), 2.9 + 0.3 * 2.95)
    np.testing.assert_allclose(prediction.Ts_world_object[0], expected.matrix, atol=0.02)


@pytest.mark.parametrize("noise_m", [0.0, 0.005])
def test_a_learned_prediction_beats_straight_on_around_a_bend(noise_m: float):
    def off_m(config: PredictorConfig) -> float:
        ends = np.arange(3.0, 9.0, 0.5)
        return float(np.mean([error_m(watched(config, BEND, end, noise_m), BEND, end + 2.0) for end in ends]))

    assert off_m(Lstm()) < 0.7 * min(off_m(Kalman()), off_m(ConstantVelocity()))


def test_a_learned_prediction_goes_straight_on_beyond_its_horizon():
    end_s = 3.0 + float(HORIZONS_S[-1])
    predictor = watched(Lstm(), CIRCLE, 3.0)
    prediction = predictor.predict(end_s + np.array([0.0, 1.0, 2.0, 4.0]))
    assert prediction is not None
    xyz = prediction.Ts_world_object[:, :3, 3]
    np.testing.assert_allclose(xyz[2] - xyz[0], 2.0 * (xyz[1] - xyz[0]), atol=1e-9)
    np.testing.assert_allclose(xyz[3] - xyz[0], 4.0 * (xyz[1] - xyz[0]), atol=1e-9)


def test_a_learned_prediction_sees_far_around_a_bend():
    """8 s ahead, where arms go that take long: a straight line is off by a tenth of a metre there."""
    learned, straight = (error_m(watched(config, BEND, 3.0), BEND, 11.0) for config in (Lstm(), Kalman()))
    assert learned < 0.01 and straight > 0.05


def test_a_learned_prediction_moves_without_jumps_in_speed():
    """An arm that follows it must not be asked for what its joints cannot do."""
    every_s = 0.02
    predictor = watched(Lstm(), BEND, 3.0)
    prediction = predictor.predict(3.0 + np.arange(0.0, 14.0, every_s))
    assert prediction is not None
    velocity = np.diff(prediction.Ts_world_object[:, :3, 3], axis=0) / every_s
    assert np.linalg.norm(np.diff(velocity, axis=0), axis=1).max() < 5e-4


def test_the_curve_between_horizons_is_scipys_natural_spline():
    known = np.random.default_rng(0).normal(size=(len(HORIZONS_S), 4))
    spline = CubicSpline(HORIZONS_S, known, bc_type="natural")
    ahead_s = np.linspace(HORIZONS_S[0], HORIZONS_S[-1], 301)
    np.testing.assert_allclose(along(curve(known), ahead_s), spline(ahead_s), atol=1e-12)
    before, after = known[0] - 0.5 * spline(HORIZONS_S[0], 1), known[-1] + 3.0 * spline(HORIZONS_S[-1], 1)
    outside_s = np.array([HORIZONS_S[0] - 0.5, HORIZONS_S[-1] + 3.0])
    np.testing.assert_allclose(along(curve(known), outside_s), [before, after], atol=1e-12)


def test_before_the_network_has_seen_enough_a_filter_answers():
    early, filtered = (watched(config, LINE, 0.1) for config in (Lstm(), Kalman()))
    a, b = early.predict(np.array([2.0])), filtered.predict(np.array([2.0]))
    assert a is not None and b is not None
    np.testing.assert_array_equal(a.Ts_world_object, b.Ts_world_object)


def test_a_learned_prediction_knows_the_velocity_of_now():
    prediction = watched(Lstm(), CIRCLE, 3.0).predict(np.array([4.0]))
    assert prediction is not None
    np.testing.assert_allclose(prediction.velocity_mps, CIRCLE.velocity_at(3.0), atol=1e-3)


@pytest.mark.parametrize("config", CAUSAL, ids=lambda c: c.kind)
def test_one_detection_is_enough_to_stay(config: PredictorConfig):
    predictor = make_predictor(config, forbidden)
    predictor.observe(observation(0.0, LINE.pose_at(0.0)))
    prediction = predictor.predict(np.array([0.0, 1.0]))
    assert prediction is not None
    np.testing.assert_allclose(prediction.Ts_world_object, [LINE.pose_at(0.0).matrix] * 2, atol=1e-12)


@pytest.mark.parametrize("config", [Kalman(), Lstm()], ids=lambda c: c.kind)
def test_the_further_ahead_the_less_is_known(config: PredictorConfig):
    prediction = watched(config, BEND, 3.0).predict(np.array([3.0, 5.0, 7.0, 11.0]))
    assert prediction is not None
    assert prediction.position_std_m[0] > 0.0
    assert (np.diff(prediction.position_std_m) > 0.0).all()


def test_the_oracle_says_the_truth():
    predictor = make_predictor(Oracle(), CIRCLE.pose_at)
    predictor.observe(observation(1.0, CIRCLE.pose_at(1.0)))
    prediction = predictor.predict(np.array([5.0]))
    assert prediction is not None
    np.testing.assert_array_equal(prediction.Ts_world_object[0], CIRCLE.pose_at(5.0).matrix)
    assert np.linalg.norm(prediction.velocity_mps) == pytest.approx(0.03, rel=1e-3)
