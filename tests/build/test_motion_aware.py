"""The motion-aware model: training, probabilities, measures of them, files."""

from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from backend.build import motion_data
from backend.build.attempts import Attempts
from backend.build.motion_curves import curves
from backend.build.motion_data import AttemptSettings, GraspChoice, columns, draw, gather
from backend.build.motion_figure import draw_curves
from backend.build.motion_measure import REPEATS, by_distance, chance, measure, repeated, worth
from backend.build.motion_metrics import agreement, best_sharpness
from backend.knowledge.motion_aware import (
    MotionAwareModel,
    sigmoid,
)
from backend.knowledge.motion_features import grasp_features, motion_features
from backend.pose import Array, Pose
from tests.motion_models import drawn_model, random_grasps
from tests.planted_rig import make_planted_rig, planted_source

SETTINGS = AttemptSettings(
    choices=(GraspChoice(0.4, 0.0, 0.0), GraspChoice(0.6, 0.012, 0.1)), misplaced_m=0.001, misplaced_rad=0.01
)


def quiet(text: str) -> None:
    pass


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> tuple[MotionAwareModel, Attempts]:
    """A model of the planted rule."""
    from backend.build.motion_aware import TrainingSettings, build_motion_aware

    cache = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion_data, "cache_folder", lambda: cache)
        source = planted_source(settings=SETTINGS)
        attempts = gather(source, 3000, 1, quiet)
        return build_motion_aware(source, attempts, quiet, TrainingSettings(epochs=20)), attempts


def test_numpy_gives_what_torch_gives():
    import torch

    from backend.build.motion_aware import Network, exported

    with torch.random.fork_rng():
        torch.manual_seed(3)
        network = Network().eval()
    model = replace(drawn_model(), layers=exported(network))
    Ts, rng = random_grasps(60), np.random.default_rng(1)
    speeds, directions = rng.uniform(0.005, 0.05, 60), rng.uniform(-np.pi, np.pi, 60)
    features = np.concatenate([grasp_features(Ts, 0.05), motion_features(speeds, directions)], axis=1)
    normalised = ((features - model.center) / model.scale).astype(np.float32)
    with torch.no_grad():
        exact = network(torch.from_numpy(normalised))
        expected = torch.sigmoid(exact).double().numpy()
    assert float(exact.std()) > 0.01
    np.testing.assert_allclose(sigmoid(model.logits(Ts, speeds, directions)), expected, atol=1e-3)
    one = model.quality(Ts, float(speeds[0]), float(directions[0]))
    each = model.logits(Ts, np.full(60, speeds[0]), np.full(60, directions[0]))
    np.testing.assert_allclose(one, sigmoid(each), atol=1e-6)


def test_the_planted_rule_is_learnt(learnt: tuple[MotionAwareModel, Attempts]):
    measured = learnt[0].facts["measured"]
    for part in ("trials", "grasps"):
        base = measured[part]["base_rate"]
        assert 0.5 < base < 0.9
        assert measured[part]["accuracy"] > max(base, 1.0 - base) + 0.08, (part, measured[part])
        assert measured[part]["brier"] < 0.7 * base * (1.0 - base)
    head_on, away = (learnt[0].quality(planted_source().Ts_object_grasp[:1], 0.05, d)[0] for d in (np.pi, 0.0))
    assert head_on > 0.9 > away + 0.1


def test_the_ranking_is_worth_more_than_any_grasp(learnt: tuple[MotionAwareModel, Attempts]):
    source = planted_source(settings=replace(SETTINGS, speeds_mps=(0.04, 0.05), misplaced_m=0.015))
    found = worth(make_planted_rig("mico", "cube"), source, learnt[0], 200)
    assert found.ranked > found.anyhow + 2.0 * found.standard_error > found.anyhow


def test_fresh_attempts_agree_with_what_was_measured(learnt: tuple[MotionAwareModel, Attempts]):
    fresh = measure(planted_source(settings=SETTINGS), learnt[0], 300, 3000)
    kept = learnt[0].facts["measured"]["trials"]
    of_all, *bands = fresh["fresh"].values()
    assert of_all["n"] == 300 and fresh["chance"]["cases"] == 30
    assert of_all["accuracy"] == pytest.approx(kept["accuracy"], abs=0.07)
    assert fresh["chance"]["accuracy"] >= of_all["accuracy"] - 0.07
    assert sum(band["n"] for band in bands) == 300
    assert sum(band["n"] * band["brier"] for band in bands) == pytest.approx(300 * of_all["brier"])


def test_attempts_are_told_apart_by_how_far_beside_a_known_grasp_they_are(learnt: tuple[MotionAwareModel, Attempts]):
    source = planted_source(settings=SETTINGS)
    cases = [draw(source, index) for index in range(9)]
    for k, shift_mm in enumerate((0.0, 0.0, 14.0, 14.9, 15.1, 20.0, 30.0, 40.0, 50.0)):
        beside = Pose(source.Ts_object_grasp[cases[k].grasp]) @ Pose.from_xyz_yaw((0.0, 0.0, shift_mm / 1000.0), 0.2)
        cases[k] = replace(cases[k], T_object_grasp=beside, variant=0 if k == 0 else k)
    attempts = columns(cases, [(True, "held")] * 9)
    found = by_distance(source, learnt[0], attempts)
    assert {name: row["n"] for name, row in found.items()} == {
        "all": 9,
        "as in the database": 1,
        "less than 15 mm beside": 3,
        "15 mm or more beside": 5,
    }
    assert list(by_distance(source, learnt[0], attempts.take(np.arange(1)))) == ["all", "as in the database"]


def test_the_same_attempts_give_the_same_model(learnt: tuple[MotionAwareModel, Attempts]):
    from backend.build.motion_aware import TrainingSettings, build_motion_aware

    source, few = planted_source(settings=SETTINGS), learnt[1].take(np.arange(400))
    first, second = (build_motion_aware(source, few, quiet, TrainingSettings(epochs=2)) for _ in range(2))
    for (weight, bias), (again, bias_again) in zip(first.layers, second.layers, strict=True):
        assert weight.tobytes() == again.tobytes() and bias.tobytes() == bias_again.tobytes()


def test_measures_are_what_the_hand_computes():
    probability = np.array([0.9, 0.8, 0.3, 0.6, 0.1])
    held = np.array([True, False, True, True, False])
    found = agreement(probability, held)
    assert (found.n, found.base_rate, found.accuracy) == (5, 0.6, 0.6)
    assert found.false_positive_rate == 0.5 and found.false_negative_rate == pytest.approx(1 / 3)
    assert found.brier == pytest.approx((0.01 + 0.64 + 0.49 + 0.16 + 0.01) / 5)
    assert found.calibration_error == pytest.approx((0.1 + 0.8 + 0.7 + 0.4 + 0.1) / 5)
    assert found.log_loss == pytest.approx(-np.mean(np.log([0.9, 0.2, 0.3, 0.6, 0.9])))
    together = agreement(np.array([0.71, 0.79]), np.array([True, False]))
    assert together.calibration_error == pytest.approx(0.25)
    assert agreement(np.array([0.7]), np.array([True])).false_positive_rate is None


def test_sharpness_undoes_a_known_temperature():
    rng = np.random.default_rng(0)
    logits = rng.normal(0.5, 2.0, 40_000)
    held = rng.random(40_000) < sigmoid(logits)
    for temperature in (0.4, 1.0, 3.0):
        assert best_sharpness(logits / temperature, held) == pytest.approx(temperature, rel=0.05)


def test_sharpening_scales_the_log_odds():
    from backend.build.motion_aware import sharpened

    model, Ts = drawn_model(), random_grasps(20)
    speeds, directions = np.full(20, 0.03), np.linspace(-3.0, 3.0, 20)
    before, after = (m.logits(Ts, speeds, directions) for m in (model, sharpened(model, 1.7)))
    np.testing.assert_allclose(after, 1.7 * before, rtol=2e-3, atol=2e-3)


def test_chance_is_what_repeated_coins_leave():
    rng = np.random.default_rng(0)
    certain = chance(np.tile([[1.0], [0.0]], (20, REPEATS)))
    assert (certain.cases, certain.accuracy, certain.brier) == (40, 1.0, 0.0)
    coins = chance((rng.random((4000, REPEATS)) < 0.5).astype(np.float64))
    assert coins.accuracy == pytest.approx(0.5, abs=0.02) and coins.brier == pytest.approx(0.25, abs=0.005)
    loaded = chance((rng.random((4000, REPEATS)) < 0.9).astype(np.float64))
    assert loaded.brier == pytest.approx(0.09, abs=0.005) and loaded.accuracy == pytest.approx(0.9, abs=0.02)


def test_a_repeated_case_differs_in_its_misplacement_only():
    source = planted_source(settings=SETTINGS)
    seen: list[tuple[Array, Array, Array]] = []

    class Watching:
        def attempt(self, *arguments: object) -> object:
            T_grasp, T_believed, velocity = cast(tuple[Pose, Pose, Array], arguments)
            seen.append((T_grasp.matrix, T_believed.matrix, velocity))
            return make_planted_rig("", "").attempt(T_grasp, T_believed, velocity)

    held = repeated(Watching(), source, [motion_data.draw(source, 5)])  # pyright: ignore[reportArgumentType]
    assert held.shape == (1, REPEATS) and len(seen) == REPEATS
    assert all(np.array_equal(T, seen[0][0]) and np.array_equal(v, seen[0][2]) for T, _, v in seen)
    assert len({T.tobytes() for _, T, _ in seen}) == REPEATS


def test_curves_count_every_attempt_and_know_what_comes_head_on():
    ahead = Pose.from_xyz_rpy((0.0, 0.0, 0.1), (0.0, np.pi / 2, 0.0)).matrix
    down = Pose.from_xyz_rpy((0.0, 0.0, 0.1), (np.pi, 0.0, 0.0)).matrix
    attempts = Attempts(
        index=np.arange(3),
        grasp=np.zeros(3, dtype=np.int64),
        variant=np.zeros(3, dtype=np.int64),
        Ts_object_grasp=np.array([ahead, ahead, down]),
        misplaced=np.zeros((3, 3)),
        velocity_mps=np.array([[0.01, 0.0], [-0.049, 0.001], [0.0, 0.02]]),
        held=np.array([False, True, True]),
        why=np.array(["", "", ""]),
    )
    found = curves(attempts, np.array([0.2, 0.7, 0.9]), (0.005, 0.05))
    assert sum(found["speed_mps"]["n"]) == sum(found["direction_rad"]["n"]) == 3
    behind = found["from_behind_rad"]
    assert behind["n"] == [1, 0, 0, 0, 0, 1] and behind["held"] == [0, 0, 0, 0, 0, 1]
    assert (behind["model"][0], behind["model"][-1]) == (0.2, 0.7)


def test_the_figure_is_drawn(learnt: tuple[MotionAwareModel, Attempts], tmp_path: Path):
    path = draw_curves("mico", [learnt[0]], tmp_path / "deep")
    assert path.name == "motion_aware_mico.png" and path.stat().st_size > 10_000
