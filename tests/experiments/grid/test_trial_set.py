"""Trial sets: what is written is what is read, and what is wrong is named by file, line and column."""

import csv
import io
from collections.abc import Callable

import numpy as np
import pytest

from backend.drawing import setup_of_seed
from backend.errors import InvalidInputError
from backend.experiments.grid.trial_set import drawn_set, starts_of, to_csv
from backend.scenario import load_scenario, scenario_names
from backend.tasks.setup import TrialSetup
from backend.tasks.start import setup_of, start_of

SCENARIO = "ur5_linear"
Row = dict[str, str]


def text_of(*names: str, trials: int = 1) -> str:
    return to_csv(row for name in names for row in drawn_set(load_scenario(name), ["cube"], trials, 0))


def changed(change: Callable[[Row], None], name: str = SCENARIO) -> str:
    """A set of two trials whose second is changed."""
    rows = list(csv.DictReader(io.StringIO(text_of(name, trials=2))))
    change(rows[1])
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[1]))
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def setting(column: str, value: object) -> Callable[[Row], None]:
    return lambda row: row.update({column: str(value)})


def assert_same_start(a: TrialSetup, b: TrialSetup) -> None:
    for t_s in (0.0, 3.3, a.motion.duration_s):
        before, after = (s.motion.pose_at(t_s) @ s.T_tray_object for s in (a, b))
        np.testing.assert_allclose(before.matrix, after.matrix, atol=1e-12)
    np.testing.assert_allclose(a.tray_size_m, b.tray_size_m, atol=1e-12)
    assert [name for name, _ in a.obstacles] == [name for name, _ in b.obstacles]
    for (_, before), (_, after) in zip(a.obstacles, b.obstacles, strict=True):
        np.testing.assert_allclose(before.matrix, after.matrix, atol=1e-12)
    assert (a.slab is None) == (b.slab is None)
    if a.slab is not None and b.slab is not None:
        np.testing.assert_allclose(a.slab.T_world_box.matrix, b.slab.T_world_box.matrix, atol=1e-12)
        assert a.slab.size_m == b.slab.size_m


@pytest.mark.parametrize("name", scenario_names())
def test_what_is_written_is_read_back_to_the_last_digit(name: str):
    rows = drawn_set(load_scenario(name), ["cube", "power_drill"], 3, 5)
    read = starts_of(to_csv(rows), "set.csv")
    assert [start for starts in read.values() for _, start in starts] == [row.start for row in rows]
    assert [seed for starts in read.values() for seed, _ in starts] == [5, 6, 7] * 2


@pytest.mark.parametrize("name", scenario_names())
def test_numbers_make_the_start_that_they_were_made_from(name: str):
    scenario = load_scenario(name)
    for seed in range(3):
        setup = setup_of_seed(scenario, seed)
        assert_same_start(setup_of(start_of(setup), scenario.task.kind, scenario.object), setup)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (setting("robot", "ur6"), ["column robot", "'ur6'", "ur5_robotiq"]),
        (setting("task", "liner"), ["column task", "'liner'", "linear_slab"]),
        (setting("object", ""), ["column object", "cube"]),
        (setting("seed", "-1"), ["column seed", "'-1'", "whole number"]),
        (setting("object_x_m", "far"), ["column object_x_m", "'far' is not a number"]),
        (setting("object_x_m", "nan"), ["column object_x_m", "nan is not from -3 to 3"]),
        (
            setting("object_y_m", 450.0),
            ["column object_y_m", "450.0", "metres are wanted, this looks like millimetres"],
        ),
        (setting("start_speed_mps", 50), ["column start_speed_mps", "50", "m/s are wanted", "mm/s or cm/s"]),
        (setting("start_speed_mps", 0.00005), ["column start_speed_mps", "km/s"]),
        (setting("object_yaw_rad", 90), ["column object_yaw_rad", "90", "degrees"]),
        (setting("belt_end_z_m", ""), ["column belt_end_z_m", "missing"]),
    ],
)
def test_a_wrong_value_is_named_by_file_line_and_column(change: Callable[[Row], None], words: list[str]):
    with pytest.raises(InvalidInputError) as refusal:
        starts_of(changed(change), "my.csv")
    for word in ["my.csv, line 3", *words]:
        assert word in str(refusal.value)


def test_a_belt_in_the_wrong_unit_is_too_short():
    def in_kilometres(row: Row) -> None:
        for column in ("object_x_m", "object_y_m", "belt_end_x_m", "belt_end_y_m"):
            row[column] = str(float(row[column]) / 1000.0)

    with pytest.raises(InvalidInputError, match=r"line 3, columns belt_end_x_m, .*: the belt is only 0\.001 m"):
        starts_of(changed(in_kilometres), "my.csv")


def test_an_object_in_the_arm_is_refused():
    def in_the_base(row: Row) -> None:
        row.update(object_x_m="-0.5", object_y_m="0.0", belt_end_x_m="0.5", belt_end_y_m="0.0")

    with pytest.raises(InvalidInputError, match=r"line 3, columns object_x_m, object_y_m, object_z_m: .* base"):
        starts_of(changed(in_the_base), "my.csv")


def test_what_a_task_does_not_have_is_refused():
    text = text_of("ur5_linear", "ur5_circular").replace("ur5_robotiq,circular,", "ur5_robotiq,linear,")
    with pytest.raises(InvalidInputError, match="line 3, column circle_x_m: the task linear has none"):
        starts_of(text, "my.csv")


def test_columns_are_checked_before_rows():
    text = text_of(SCENARIO)
    with pytest.raises(InvalidInputError, match=r"line 1: columns seed are missing"):
        starts_of(text.replace(",seed,", ",sead,", 1), "my.csv")
    with pytest.raises(InvalidInputError, match=r"no column 'belt_end_xm'. Did you mean 'belt_end_x_m'"):
        starts_of(text.replace("belt_end_x_m", "belt_end_xm"), "my.csv")
    with pytest.raises(InvalidInputError, match="line 2: more values than columns"):
        starts_of(text.strip() + ",7\n", "my.csv")
    with pytest.raises(InvalidInputError, match="has no rows"):
        starts_of(text.splitlines()[0], "my.csv")
    with pytest.raises(InvalidInputError, match="are missing"):
        starts_of("", "my.csv")


def test_every_wrong_row_is_named():
    text = changed(setting("object_y_m", 450)).replace("cube", "teapot", 1)
    with pytest.raises(InvalidInputError, match=r"line 2, column object: (.*\n)+.*line 3, column object_y_m"):
        starts_of(text, "my.csv")
