"""The measurement of predictors: its motions, its fairness, its command."""

import json
from typing import Any

import numpy as np
import pytest

from backend.cli import main
from backend.experiments.prediction import AHEAD_S, PREDICTORS, families, measure


@pytest.mark.parametrize("family", families(), ids=lambda family: family.name)
def test_motions_are_continuous_and_repeatable(family: Any):
    (way, duration_s), (again, _) = (family.draw(np.random.default_rng(3)) for _ in range(2))
    t_s = np.linspace(0.0, min(duration_s, 40.0), 2000)
    xyz = way(t_s)
    assert xyz.shape == (2000, 3)
    np.testing.assert_array_equal(xyz, again(t_s))
    step_m = np.linalg.norm(np.diff(xyz, axis=0), axis=1)
    assert 0.0 < step_m.max() <= 0.1 * (t_s[1] - t_s[0])


def test_a_straight_belt_is_foretold_by_all_but_the_one_that_stays():
    rows = [row for row in measure(1, 0, ["ur5_linear"]) if row.noise_m == 0.0]
    assert [row.predictor for row in rows] == list(PREDICTORS)
    for row in rows[:-1]:
        assert row.off_m.max() < 2e-3
    np.testing.assert_allclose(
        rows[-1].off_m, np.broadcast_to(0.05 * np.array(AHEAD_S), rows[-1].off_m.shape), atol=1e-9
    )


def test_learning_pays_under_noise():
    rows = [row for row in measure(3, 1, ["mico_circular"]) if row.noise_m == 0.005]
    off_m = {row.predictor: row.off_m.mean() for row in rows}
    assert off_m["lstm"] < 0.7 * min(off_m["kalman"], off_m["constant_velocity"])


def test_the_learned_predictor_knows_how_far_off_it_is_and_a_filter_not_told_the_noise_does_not():
    rows = {row.predictor: row.as_dict() for row in measure(3, 1, ["mico_circular"]) if row.noise_m == 0.005}
    within = {name: np.array(row["within_two_sigma"], dtype=np.float64) for name, row in rows.items()}
    assert (within["lstm"] >= 0.9).all() and (within["kalman"] < 0.9).all()
    assert rows["last_pose"]["within_two_sigma"] is None


def test_the_report_is_one_object_or_tables(capsys: pytest.CaptureFixture[str]):
    assert main(["report", "prediction", "--motions", "1", "--families", "figure_eight", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["errors"]
    assert len(rows) == 3 * len(PREDICTORS)
    assert main(["report", "prediction", "--motions", "1", "--families", "figure_eight"]) == 0
    table = capsys.readouterr().out
    assert table.count("figure_eight") == 6 and "tasks" not in table


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--motions", "0"], "--motions must be at least 1"),
        (["--seed", "-1"], "--seed must not be negative"),
        (["--families", "figure_ate"], "Did you mean 'figure_eight'?"),
    ],
)
def test_what_cannot_be_measured_is_refused(arguments: list[str], text: str, capsys: pytest.CaptureFixture[str]):
    assert main(["report", "prediction", *arguments]) == 2
    assert text in capsys.readouterr().err
