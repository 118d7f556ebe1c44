"""Scenario files: all load; what people get wrong is answered with file, key, bound and what exists."""

import json
import math
import pickle
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import InvalidInputError, NotFoundError
from backend.methods import METHODS
from backend.objects import OBJECTS
from backend.scenario import (
    SCENARIOS_DIR,
    Scenario,
    load_scenario,
    parse_scenario,
    scenario_names,
    to_toml,
    with_overrides,
)
from backend.scenario.toml import to_toml_text
from backend.tasks import TASKS

PAPER_SPEEDS_CMPS = {
    "mico": {
        "linear": 3,
        "linear_obstacles": 3,
        "linear_slab": 2,
        "linear_z": 3,
        "circular": 2,
        "sinusoidal": 1,
    },
    "ur5": {
        "linear": 5,
        "linear_obstacles": 5,
        "linear_slab": 3,
        "linear_z": 5,
        "circular": 3,
        "sinusoidal": 1,
    },
}
PAPER_RANGES_M = {"mico": (0.15, 0.4), "ur5": (0.3, 0.7)}

GOOD = """
title = "A test"
robot = "ur5_robotiq"
object = "cube"
method = "ik"

[task]
kind = "linear"
speed_mps = 0.05
distance_min_m = 0.3
distance_max_m = 0.7
"""


@pytest.fixture
def linear() -> Scenario:
    return load_scenario("ur5_linear")


def complaint_of(tmp_path: Path, text: str) -> str:
    """What ``load_scenario`` says about a file of this text, without the file's name."""
    file = tmp_path / "x.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInputError) as caught:
        load_scenario(file)
    lines = str(caught.value).splitlines()
    assert all(line.startswith(f"{file}: ") for line in lines)
    return "\n".join(line.removeprefix(f"{file}: ") for line in lines)


def test_there_is_one_scenario_for_each_robot_and_task():
    expected = {f"{robot}_{task}" for robot in PAPER_SPEEDS_CMPS for task in TASKS}
    assert expected <= set(scenario_names())


@pytest.mark.parametrize("robot", PAPER_SPEEDS_CMPS)
@pytest.mark.parametrize("kind", TASKS)
def test_the_scenario_files_are_the_papers(robot: str, kind: str):
    scenario = load_scenario(f"{robot}_{kind}")
    task = scenario.task
    assert scenario.robot == {"mico": "mico", "ur5": "ur5_robotiq"}[robot]
    assert task.kind == kind
    assert (task.distance_min_m, task.distance_max_m) == PAPER_RANGES_M[robot]
    assert (task.length_m, task.theta_min_rad) == (1.0, 0.0)
    assert math.isclose(task.theta_max_rad, 2 * math.pi)
    if task.kind == "linear_varying":
        expected = (0.01, 0.03) if robot == "mico" else (0.03, 0.05)
        assert (task.start_speed_mps, task.end_speed_mps) == expected
    else:
        assert task.speed_mps == PAPER_SPEEDS_CMPS[robot][kind] / 100


@pytest.mark.parametrize("name", scenario_names())
def test_every_scenario_survives_toml_json_and_pickle(name: str, tmp_path: Path):
    scenario = load_scenario(name)
    file = tmp_path / "copy.toml"
    file.write_text(to_toml(scenario), encoding="utf-8")
    assert load_scenario(file) == scenario
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario
    assert parse_scenario(json.loads(scenario.model_dump_json())) == scenario
    assert pickle.loads(pickle.dumps(scenario)) == scenario


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("changed", [False, True])
def test_changed_methods_events_and_odd_titles_survive_toml(linear: Scenario, name: str, changed: bool, tmp_path: Path):
    keep = "keep_each" if METHODS[name].filter.kind == "reachability_motion" else "keep"
    changes = (f"method.filter.{keep}=7", "method.predictor.kind=oracle") if changed else ()
    event = '{tick = 3, event = {kind = "move_obstacle", index = 0, x_m = 0.5, y_m = -1e-7}}'
    scenario = with_overrides(linear, [f"method={name}", *changes, f"events=[{event}]"])
    scenario = scenario.model_copy(update={"title": 'Grüße "\\ \x7f\t🤖', "description": "two\nlines"})
    file = tmp_path / "copy.toml"
    file.write_text(to_toml(scenario), encoding="utf-8")
    assert load_scenario(file) == scenario


@given(
    st.dictionaries(
        st.text(min_size=1).filter(lambda key: key.isprintable()),
        st.recursive(
            st.text() | st.booleans() | st.integers(-(2**60), 2**60) | st.floats(allow_nan=False, allow_infinity=False),
            lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text("abc.-_ ", min_size=1), inner),
            max_leaves=8,
        ),
        max_size=4,
    )
)
def test_tables_survive_toml(table: dict[str, object]):
    import tomllib

    assert tomllib.loads(to_toml_text(table)) == table


def test_a_plain_method_is_written_as_its_name(linear: Scenario):
    assert 'method = "ours_rm"' in to_toml(linear)


def test_only_what_differs_from_the_named_method_is_written(linear: Scenario):
    text = to_toml(with_overrides(linear, ["method.execution.lift_m=0.2"]))
    assert '[method]\nname = "ours_rm"\n\n[method.execution]\nlift_m = 0.2\n' in text


def test_a_method_table_changes_only_what_it_names(tmp_path: Path):
    file = tmp_path / "x.toml"
    method = '[method]\nname = "baseline"\nexecution = { lift_m = 0.2 }\n[method.predictor]\nkind = "oracle"\n'
    file.write_text(GOOD.replace('method = "ik"\n', "") + method, encoding="utf-8")
    chosen, named = load_scenario(file).method, METHODS["baseline"]
    assert chosen.execution.lift_m == 0.2
    assert chosen.predictor.kind == "oracle"
    assert chosen.filter == named.filter
    assert chosen.execution.hold_s == named.execution.hold_s


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        (
            "speed_mps = 0.05",
            "speed_mps = 0.05\nspeed = 2",
            "task.linear.speed: extra inputs are not permitted (got 2). Did you mean 'speed_mps'?",
        ),
        (
            "title",
            "zzz = 1\ntitle",
            "zzz: extra inputs are not permitted (got 1). Available: description, events, method, object, "
            "profile, robot, seed, sensing, start, task, timing, title.",
        ),
        (
            "speed_mps = 0.05",
            "speed_mps = 5.0",
            "task.linear.speed_mps: input should be less than or equal to 0.5 (got 5.0)",
        ),
        (
            "speed_mps = 0.05",
            "speed_mps = nan",
            "task.linear.speed_mps: input should be a finite number (got nan)",
        ),
        (
            "speed_mps = 0.05",
            "speed_mps = -inf",
            "task.linear.speed_mps: input should be a finite number (got -inf)",
        ),
        ("speed_mps = 0.05", "", "task.linear.speed_mps: field required"),
        (
            '"ur5_robotiq"',
            '"ur5_robotic"',
            "robot: There is no robot named 'ur5_robotic'. Available: mico, ur5_robotiq. Did you mean 'ur5_robotiq'?",
        ),
        (
            '"cube"',
            '"cub"',
            f"object: There is no object named 'cub'. Available: {', '.join(sorted(OBJECTS))}. Did you mean 'cube'?",
        ),
        (
            'method = "ik"',
            'method = "baselin"',
            f"method: There is no method named 'baselin'. Available: {', '.join(sorted(METHODS))}. "
            "Did you mean 'baseline'?",
        ),
        (
            'method = "ik"',
            "method = { }",
            f"method: a method table needs a name. Available: {', '.join(sorted(METHODS))}",
        ),
        (
            'method = "ik"',
            'method = { name = "ik", execution = { lift = 0.1 } }',
            "method.execution.lift: extra inputs are not permitted (got 0.1). Did you mean 'lift_m'?",
        ),
        (
            'kind = "linear"',
            'kind = "lineal"',
            "task: input tag 'lineal' found using 'kind' does not match any of the expected tags: "
            + ", ".join(repr(kind) for kind in TASKS),
        ),
        (
            "title",
            "sensing = { rate_hz = 1000 }\ntitle",
            "sensing.rate_hz: input should be less than or equal to 240 (got 1000)",
        ),
        ("title", "seed = -1\ntitle", "seed: input should be greater than or equal to 0 (got -1)"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, complaint: str):
    assert complaint_of(tmp_path, GOOD.replace(old, new, 1)) == complaint


def test_several_mistakes_are_named_at_once(tmp_path: Path):
    text = GOOD.replace("0.05", "9").replace('"cube"', "3")
    assert len(complaint_of(tmp_path, text).splitlines()) == 2


def test_broken_toml_names_the_line(tmp_path: Path):
    complaint = complaint_of(tmp_path, 'title = "x"\nrobot = = 3\n')
    assert complaint.startswith("not valid TOML: ")
    assert "line 2" in complaint


def test_a_file_that_is_not_text_is_refused(tmp_path: Path):
    file = tmp_path / "x.toml"
    file.write_bytes(b"title = '\xff'")
    with pytest.raises(InvalidInputError, match=r"x\.toml: not UTF-8 text \(byte 9\)"):
        load_scenario(file)


def test_a_folder_is_not_a_scenario(tmp_path: Path):
    (tmp_path / "x.toml").mkdir()
    with pytest.raises(InvalidInputError, match=r"x\.toml: cannot be read"):
        load_scenario(tmp_path / "x.toml")


def test_files_of_the_project_are_called_from_its_folder_on():
    from backend.scenario.files import shown

    assert shown(SCENARIOS_DIR / "ur5_linear.toml") == "scenarios/ur5_linear.toml"


def test_an_unknown_scenario_is_answered_with_what_exists():
    with pytest.raises(NotFoundError, match=r"no scenario named 'ur5_liner'.*mico_circular.* mean 'ur5_linear'\?"):
        load_scenario("ur5_liner")
    with pytest.raises(NotFoundError, match=r"no scenario file nowhere/x\.toml\. Available by name: mico_circular"):
        load_scenario("nowhere/x.toml")


def test_a_path_loads_as_its_name_does(linear: Scenario):
    assert load_scenario(SCENARIOS_DIR / "ur5_linear.toml") == linear
    assert load_scenario(str(SCENARIOS_DIR / "ur5_linear.toml")) == linear


def test_overrides_change_what_they_name_and_nothing_else(linear: Scenario):
    changed = with_overrides(linear, ["task.speed_mps=0.08", "object=cube", " seed = 7 ", "timing.think=paper"])
    assert (changed.task.speed_mps, changed.object, changed.seed) == (0.08, "cube", 7)  # pyright: ignore
    assert changed.timing.think == "paper"
    back = with_overrides(changed, ["task.speed_mps=0.05", "object=tomato_soup_can", "seed=0", "timing.think=budget"])
    assert back == linear


def test_a_method_can_be_replaced_and_then_changed(linear: Scenario):
    changed = with_overrides(linear, ["method=baseline", "method.filter.keep=3"])
    assert changed.method.name == "baseline"
    assert changed.method.filter.model_dump() == {"kind": "random", "keep": 3}


def test_another_kind_keeps_the_settings_they_share(linear: Scenario):
    changed = with_overrides(linear, ["task.theta_rad=1.0", "task.kind=circular"])
    assert changed.task.kind == "circular"
    assert (changed.task.theta_rad, changed.task.distance_max_m) == (1.0, 0.7)
    varying = ["task.kind=linear_varying", "task.start_speed_mps=0.01", "task.end_speed_mps=0.02"]
    assert with_overrides(linear, varying).task.kind == "linear_varying"


def test_none_takes_a_setting_back_to_its_default(linear: Scenario):
    pinned = with_overrides(linear, ["task.theta_rad=1.0", "sensing.rate_hz=5"])
    assert with_overrides(pinned, ["task.theta_rad=none", "sensing.rate_hz=none"]) == linear


@pytest.mark.parametrize(
    ("override", "complaint"),
    [
        ("task.sped=1", r"no setting of task named 'sped'\. Available: direction, .* mean 'speed_mps'\?"),
        ("tusk.speed_mps=1", r"no setting named 'tusk'\. Available: .* mean 'task'\?"),
        (
            "method.predictor.windo_s=1",
            r"no setting of method\.predictor named 'windo_s'\. Available: .*kind",
        ),
        ("task.speed_mps=9", r"^task\.speed_mps=9: task\.linear\.speed_mps: .* equal to 0\.5 \(got 9\)$"),
        ("task.speed_mps=fast", r"should be a valid number .*\(got 'fast'\)$"),
        ("task.speed_mps=nan", r"finite number \(got nan\)$"),
        ("task.speed_mps=none", r"task\.linear\.speed_mps: field required$"),
        ("title.x=3", r"^title is a single value: it has no settings of its own\.$"),
        ("task", r"^An override is path=value, such as task\.speed_mps=0\.08, not 'task'\.$"),
        ("=3", r"^An override is path=value"),
        ("task..x=3", r"^An override is path=value"),
        ("task.kind=lineal", r"tag 'lineal' .* 'linear', "),
        ("robot=mic", r"no robot named 'mic'\. .* mean 'mico'\?"),
        ("method=bas", r"no method named 'bas'"),
        (
            "events=[{tick=-1,event={kind='set_belt_rate',rate=1}}]",
            r"events\.0\.tick: .* equal to 0 \(got -1\)",
        ),
        ("events=[{tick=1,event={kind='set_belt_rate',rates=1}}]", r"mean 'rate'\?"),
    ],
)
def test_wrong_overrides_are_explained(linear: Scenario, override: str, complaint: str):
    with pytest.raises(InvalidInputError, match=complaint):
        with_overrides(linear, [override])
