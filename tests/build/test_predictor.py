"""The trained predictor: how it is made, kept and run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from backend.build.sequences import LOOKS, SequenceSettings, draw_sequences
from backend.errors import InvalidInputError, MissingResourceError
from backend.knowledge.predictor import load_weights, predictor_file, save_weights
from backend.pipeline.predict.lstm import Forward, LstmPredictor
from backend.pipeline.predict.window import FEATURES, HORIZONS_S, MIN_BINS, Windows, normalised
from backend.pose import Array

HORIZONS = len(HORIZONS_S)


def windows_of(states: Array) -> Windows:
    """Of whole sequences looked at every 0.05 s."""
    age_s = np.tile(0.05 * np.arange(LOOKS, dtype=np.float64), (len(states), 1))
    return normalised(age_s, states, np.ones(states.shape[:2], dtype=np.bool_))


def test_numpy_gives_what_torch_gives():
    import torch

    from backend.build.predictor_network import Network, Spread, exported

    with torch.random.fork_rng():
        torch.manual_seed(3)
        network, spread = Network(), Spread()
    drawn = draw_sequences(50, np.random.default_rng(0))
    windows = normalised(drawn.age_s, drawn.states, drawn.seen)
    assert len(set(windows.lengths.tolist())) > 3
    with torch.no_grad():
        remembered = network.remembered(torch.from_numpy(windows.tokens), torch.from_numpy(windows.lengths))
        answers, spreads = network.answer(remembered).numpy(), spread(remembered).numpy()
    forward = Forward(exported(network, spread, {}))
    for tokens, length, *expected in zip(windows.tokens, windows.lengths, answers, spreads, strict=True):
        for found, wanted in zip(forward(tokens[:length]), expected, strict=True):
            np.testing.assert_allclose(found, wanted, atol=1e-5)


@pytest.mark.parametrize("noise_m", [0.0, 0.002, 0.006])
def test_one_position_in_twenty_is_off_by_more_than_two_standard_deviations(noise_m: float):
    """On motions like those of the training, however noisy, nineteen in twenty or a little more are within."""
    settings = SequenceSettings(clean=1.0 if noise_m == 0.0 else 0.0, noise_m=noise_m)
    drawn = draw_sequences(3000, np.random.default_rng(11), settings)
    windows = normalised(drawn.age_s, drawn.states, drawn.seen)
    forward = Forward(load_weights(FEATURES, HORIZONS))
    told = [forward(tokens[:length]) for tokens, length in zip(windows.tokens, windows.lengths, strict=True)]
    answers, spreads = (np.array(part) for part in zip(*told, strict=True))
    off_m = np.linalg.norm((windows.states(answers) - drawn.future)[..., :3], axis=2)
    known = (windows.lengths >= MIN_BINS) & (windows.scale[:, 0, 0] > 1e-9)
    share = (off_m <= windows.reach_m(spreads))[known].mean(axis=0)
    assert ((share > 0.93) & (share < 0.985)).all(), share


def test_weights_are_up_to_date_for_their_own_seed_and_settings_only():
    from backend.build.predictor import PredictorSettings, is_up_to_date, source_digest

    weights = load_weights(FEATURES, HORIZONS)
    made = replace(weights, facts={**weights.facts, "source": source_digest(3, PredictorSettings())})
    assert is_up_to_date(made, 3)
    assert not is_up_to_date(made, 4) and not is_up_to_date(made, 3, PredictorSettings(steps=12_001))


def test_a_killed_training_ends_as_one_that_was_not(tmp_path: Path):
    from backend.build.predictor import PredictorSettings, SpreadSettings, build_predictor

    brief = SpreadSettings(steps=3, batch=16, validation=20)
    settings = PredictorSettings(steps=6, batch=16, validation=20, checkpoint_every=2, report_every=3, spread=brief)
    told: list[str] = []

    def killed(text: str) -> None:
        told.append(text)
        if len(told) == 1:
            raise KeyboardInterrupt

    whole = build_predictor(5, tmp_path / "a.pt", told.append, settings)
    told.clear()
    with pytest.raises(KeyboardInterrupt):
        build_predictor(5, tmp_path / "b.pt", killed, settings)
    resumed = build_predictor(5, tmp_path / "b.pt", told.append, settings)
    assert told[1] == "going on at step 2"
    for name in ("lstm_in", "lstm_hidden", "lstm_bias"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(resumed, name))
    for one, other in zip(whole.spread, resumed.spread, strict=True):
        np.testing.assert_array_equal(one[0], other[0])
    assert whole.facts == resumed.facts


def test_a_checkpoint_of_another_training_is_left_alone(tmp_path: Path):
    from backend.build.predictor import PredictorSettings, SpreadSettings, build_predictor

    brief = SpreadSettings(steps=3, batch=16, validation=20)
    settings = PredictorSettings(steps=2, batch=16, validation=20, spread=brief)
    told: list[str] = []
    build_predictor(5, tmp_path / "a.pt", told.append, settings)
    build_predictor(6, tmp_path / "a.pt", told.append, settings)
    (tmp_path / "a.pt").write_bytes((tmp_path / "a.pt").read_bytes()[:1000])
    build_predictor(6, tmp_path / "a.pt", told.append, settings)
    assert ["another training" in told[1], "cannot be read" in told[3]] == [True, True], told


def test_the_same_seed_draws_the_same_sequences():
    a, b = (draw_sequences(20, np.random.default_rng(7)) for _ in range(2))
    np.testing.assert_array_equal(a.states, b.states)
    np.testing.assert_array_equal(a.future, b.future)
    assert a.seen[:, 0].all() and (a.age_s[:, 0] == 0.0).all()


def test_drawn_sequences_go_on_where_they_were_seen():
    drawn = draw_sequences(200, np.random.default_rng(1), SequenceSettings(clean=1.0))
    np.testing.assert_allclose(drawn.states[:, 0], drawn.future[:, 0], atol=1e-12)
    step_m = np.linalg.norm(np.diff(drawn.states[..., :3], axis=1), axis=2) / np.diff(drawn.age_s, axis=1)
    assert 0.0 < step_m.max() < 0.1 * np.sqrt(1.0 + 3.0**2)


def test_some_belts_turn_round():
    def share_that_end_backwards(reversal: float) -> float:
        settings = SequenceSettings(shares=(1.0, 0.0, 0.0, 0.0), clean=1.0, quick_change=1.0, reversal=reversal)
        drawn = draw_sequences(1000, np.random.default_rng(3), settings)
        at_first = drawn.states[:, -2, :3] - drawn.states[:, -1, :3]  # looks are newest first
        at_last = drawn.future[:, -1, :3] - drawn.future[:, -2, :3]
        return float((np.einsum("ij,ij->i", at_first, at_last) < 0.0).mean())

    assert share_that_end_backwards(0.0) == 0.0
    assert 0.2 < share_that_end_backwards(0.5) < 0.5
    assert share_that_end_backwards(1.0) > 0.5


def test_predictions_move_and_turn_with_what_they_are_made_from():
    weights = load_weights(FEATURES, HORIZONS)
    drawn = draw_sequences(20, np.random.default_rng(2))
    cos, sin = np.cos(1.1), np.sin(1.1)
    turn = np.array([[cos, -sin, 0, 0], [sin, cos, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    shift = np.array([0.3, -0.2, 0.1, 2.0])
    forward = Forward(weights)

    def predicted(states: Array) -> Array:
        windows = windows_of(states)
        return windows.states(np.array([forward(tokens)[0] for tokens in windows.tokens]))

    np.testing.assert_allclose(
        predicted(drawn.states @ turn.T + shift), predicted(drawn.states) @ turn.T + shift, atol=1e-5
    )


def test_normalising_and_back_is_nothing():
    drawn = draw_sequences(50, np.random.default_rng(4), SequenceSettings(clean=0.0, shares=(0.4, 0.3, 0.3, 0.0)))
    windows = windows_of(drawn.states)
    off = drawn.future - windows.states(np.zeros_like(drawn.future))
    answer = (off @ windows.turn)[..., :3] / windows.scale[..., :3]
    back = windows.states(np.pad(answer, ((0, 0), (0, 0), (0, 1))))
    np.testing.assert_allclose(back[..., :3], drawn.future[..., :3], atol=1e-9)


@pytest.mark.parametrize("rate_hz", [5.0, 20.0, 240.0])
def test_memory_is_bounded_at_any_rate(rate_hz: float):
    from tests.contracts.test_predictors import LINE, observation

    predictor = LstmPredictor()
    for k in range(int(15 * rate_hz)):
        predictor.observe(observation(k / rate_hz, LINE.pose_at(k / rate_hz)))
    prediction = predictor.predict(np.array([16.0]))
    assert prediction is not None
    np.testing.assert_allclose(prediction.Ts_world_object[0, :3, 3], LINE.pose_at(16.0).xyz_m, atol=1e-3)
    assert len(predictor._rows) <= 4096  # pyright: ignore[reportPrivateUsage]


def test_saved_weights_come_back(tmp_path: Path):
    weights = load_weights(FEATURES, HORIZONS)
    again = load_weights(FEATURES, HORIZONS, save_weights(weights, tmp_path / "w.npz"))
    np.testing.assert_array_equal(weights.lstm_hidden, again.lstm_hidden)
    assert again.facts == weights.facts
    assert list(tmp_path.iterdir()) == [tmp_path / "w.npz"]


def test_the_shipped_weights_say_how_they_were_made():
    facts = load_weights(FEATURES, HORIZONS).facts
    assert {"seed", "settings", "sequences", "torch", "validation", "spread"} <= set(facts)


def test_missing_weights_name_the_command(tmp_path: Path):
    with pytest.raises(MissingResourceError, match=r"gone\.npz is missing.*python -m backend build predictor"):
        LstmPredictor(tmp_path / "gone.npz")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_a_truncated_file_is_refused_by_name(tmp_path: Path, share: float):
    whole = predictor_file().read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InvalidInputError, match=r"cut\.npz: not a trained predictor.*build predictor"):
        LstmPredictor(tmp_path / "cut.npz")


def test_a_foreign_file_is_refused_by_name(tmp_path: Path):
    np.savez(tmp_path / "other.npz", Ts_object_grasp=np.eye(4))
    (tmp_path / "text.npz").write_text("weights, honestly")
    for name in ("other.npz", "text.npz"):
        with pytest.raises(InvalidInputError, match=rf"{name}: not a trained predictor"):
            LstmPredictor(tmp_path / name)


def test_weights_of_another_network_are_refused(tmp_path: Path):
    fine = load_weights(FEATURES, HORIZONS)
    for bad in (fine.lstm_in[:, :-1], np.full_like(fine.lstm_in, np.nan), fine.lstm_in[0]):
        wrong = replace(fine, lstm_in=bad)
        path = save_weights(wrong, tmp_path / "w.npz")
        with pytest.raises(InvalidInputError, match=r"w\.npz: not a trained predictor .arrays of.*build predictor"):
            LstmPredictor(path)
