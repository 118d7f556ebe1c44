"""A scenario that says how its trial begins: read and written, begun as it says, refused where it can't be."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from backend.drawing import setup_of_seed
from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.experiments.grid.trial_set import drawn_set, to_csv
from backend.experiments.trial import run_trial
from backend.record import load_trace
from backend.scenario import Scenario, load_scenario, scenario_names, to_toml, with_overrides
from backend.tasks.start import OBSTACLE_NAMES, Start, start_of

NAMES = ("robot", "task", "object", "seed")


def begun(scenario: Scenario, start: Start) -> Scenario:
    return Scenario.model_validate(scenario.model_dump() | {"start": start})


@pytest.mark.parametrize("name", scenario_names())
def test_a_start_survives_toml_and_is_what_it_was_made_from(name: str, tmp_path: Path):
    scenario = load_scenario(name)
    drawn = setup_of_seed(scenario, 4)
    (tmp_path / "begun.toml").write_text(to_toml(begun(scenario, start_of(drawn))))
    read = load_scenario(tmp_path / "begun.toml")
    assert read.start == start_of(drawn)
    again = setup_of_seed(read, 4)
    np.testing.assert_array_equal(again.motion.pose_at(2.0).matrix, drawn.motion.pose_at(2.0).matrix)
    other = setup_of_seed(read, 5)
    np.testing.assert_allclose(other.motion.pose_at(2.0).matrix, drawn.motion.pose_at(2.0).matrix, atol=1e-12)
    assert [name for name, _ in other.obstacles] == [name for name, _ in drawn.obstacles]


def test_a_row_of_a_trial_set_is_a_start_as_it_stands():
    scenario = load_scenario("ur5_linear_obstacles")
    text = to_csv(drawn_set(scenario, ["cube"], 1, 3))
    (cells,) = csv.DictReader(io.StringIO(text))
    start: Start = {name: _value(name, text) for name, text in cells.items() if text and name not in NAMES}
    drawn = setup_of_seed(scenario.model_copy(update={"object": "cube"}), 3)
    assert begun(scenario, start).start == start_of(drawn)


def _value(column: str, text: str) -> float | str:
    return text if column in OBSTACLE_NAMES else float(text)


def test_the_object_stands_where_the_start_says_and_the_trace_repeats_it(tmp_path: Path):
    scenario = load_scenario("ur5_linear")
    start = start_of(setup_of_seed(scenario, 0))
    x_m, y_m, z_m = (float(start[f"object_{axis}_m"]) for axis in "xyz")
    moved = begun(scenario, {**start, "object_y_m": y_m + 0.01, "object_yaw_rad": 0.7})
    with Episode(moved, 0) as episode:
        T = episode.world.object_pose()
    np.testing.assert_allclose(T.xyz_m, [x_m, y_m + 0.01, z_m], atol=2e-3)
    assert abs(T.yaw_rad - 0.7) < 0.01
    path = tmp_path / "trial.npz"
    record = run_trial(moved, 0, path)
    assert record.fingerprint != run_trial(scenario, 0).fingerprint
    assert run_trial(load_trace(path).scenario).fingerprint == record.fingerprint


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"object_x_m": 500.0}, ["object_x_m", "500.0", "millimetres"]),
        ({"circle_x_m": 0.3}, ["circle_x_m", "the task linear has none"]),
        ({"belt_end_xm": 0.3}, ["belt_end_xm"]),
        ({"obstacle_1": "teapot"}, ["obstacle_1", "'teapot'", "cube"]),
        ({"obstacle_1": "cube"}, ["obstacle_1_x_m", "missing"]),
        ({"object_z_m": "high"}, ["object_z_m", "'high' is not a number"]),
    ],
)
def test_a_wrong_start_is_named_by_its_column(changes: Start, words: list[str], tmp_path: Path):
    scenario = load_scenario("ur5_linear")
    start = start_of(setup_of_seed(scenario, 0)) | changes
    path = tmp_path / "wrong.toml"
    path.write_text(to_toml(scenario.model_copy(update={"start": start})))
    with pytest.raises(InvalidInputError) as refusal:
        load_scenario(path)
    for word in ["wrong.toml: start: ", *words]:
        assert word in str(refusal.value)


def test_a_start_in_the_arm_is_refused_before_anything_moves():
    scenario = load_scenario("ur5_linear")
    start = start_of(setup_of_seed(scenario, 0))
    start |= {"object_x_m": -0.5, "object_y_m": 0.0, "belt_end_x_m": 0.5, "belt_end_y_m": 0.0}
    with pytest.raises(InvalidInputError, match=r"start: .* run into its base"):
        Episode(begun(scenario, start), 0)


def test_a_start_of_another_task_is_refused_when_the_task_is_changed():
    scenario = load_scenario("ur5_linear")
    with_start = begun(scenario, start_of(setup_of_seed(scenario, 0)))
    with pytest.raises(InvalidInputError, match=r"start: .*circle_x_m: a number is missing"):
        with_overrides(with_start, ["task.kind=circular"])
