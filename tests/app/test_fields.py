"""Laws of what the page offers to set: all that the scenario's model has, as the model has it."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal

import pytest
import viser
from pydantic import Field as Bounds

from app.commands import Restart
from app.engine import TrialInfo
from app.session import Session
from app.ui import fields
from app.ui.desk import Desk, merged
from app.ui.fields import Field, fields_in
from app.ui.panels.method import MethodPanel
from app.ui.panels.panel import View
from app.ui.panels.settings import from_screen, on_screen
from app.ui.progress import Tally
from app.ui.units import SUFFIXES, split_unit
from backend.config import Config
from backend.drawing import setup_of_seed
from backend.errors import InvalidInputError
from backend.methods import METHODS
from backend.scenario import Scenario, load_scenario, scenario_names, to_toml, with_overrides
from backend.tasks.start import start_of
from tests.app.fake_episode import FakeEngine

PARTS = ("task", "sensing", "timing", "profile", "method")


def all_fields(scenario: Scenario) -> tuple[Field, ...]:
    return tuple(field for part in PARTS for field in fields_in(scenario, part))


def value_at(scenario: Scenario, path: str) -> object:
    here: Any = scenario.model_dump()
    for name in path.split("."):
        here = here[name]
    return here


def field_of(scenario: Scenario, path: str) -> Field:
    return next(field for field in all_fields(scenario) if field.path == path)


@pytest.mark.parametrize("name", scenario_names())
def test_every_field_has_the_value_the_scenario_has(name: str) -> None:
    scenario = load_scenario(name)
    for field in all_fields(scenario):
        assert field.value == value_at(scenario, field.path), field.path


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", scenario_names())
def test_what_a_widget_shows_is_read_back_as_the_same_scenario(name: str, method: str) -> None:
    scenario = with_overrides(load_scenario(name), [f"method={method}"])
    shown = [f"{field.path}={_toml(from_screen(field, on_screen(field)))}" for field in all_fields(scenario)]
    again = with_overrides(scenario, shown)
    for field in all_fields(scenario):
        value = value_at(again, field.path)
        assert value == (pytest.approx(field.value, rel=1e-4) if isinstance(value, float) else field.value), field.path


def _toml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def test_nothing_that_can_be_set_is_left_out() -> None:
    scenario = load_scenario("ur5_linear_obstacles")
    leaves: set[str] = set()

    def walk(path: str, value: object) -> None:
        if isinstance(value, dict):
            for name, below in value.items():
                walk(f"{path}.{name}", below)
        else:
            leaves.add(path)

    dump = scenario.model_dump()
    for part in PARTS:
        walk(part, dump[part])
    shown = {field.path for field in all_fields(scenario)}
    only_kinds = {path for path in leaves if path.endswith(".kind")} - shown
    assert leaves - shown == {"method.name", "method.title"} | only_kinds
    assert {path.split(".")[1] for path in only_kinds} <= {"planner", "horizon"}, "only what has a single kind"


def test_a_new_planner_shows_with_its_settings_and_no_line_of_the_page_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    class Leap(Config):
        """Jumps."""

        kind: Literal["leap"] = "leap"
        height_m: Annotated[float, Bounds(gt=0.0, le=1.0)] = 0.25
        """How high."""

    class Walk(Config):
        """Walks."""

        kind: Literal["walk"] = "walk"

    class Method(Config):
        planner: Annotated[Leap | Walk, Bounds(discriminator="kind")] = Leap()

    class Grown(Config):
        method: Method = Method()

    monkeypatch.setattr(fields, "_schema", Grown.model_json_schema)
    grown: Any = Grown()
    kind, height = fields_in(grown, "method")
    assert (kind.path, kind.choices, kind.hint) == ("method.planner.kind", ("leap", "walk"), "Jumps.")
    assert (height.label, on_screen(height)) == ("Height, cm", 25.0)
    assert height.hint == "How high. (above 0 to 100 cm)"
    assert len(fields_in(Grown(method=Method(planner=Walk())), "method")) == 1  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("path", "shown", "complaint"),
    [
        ("task.direction", "up", "task.direction: choose one of drawn, 1, -1 (got 'up')"),
        ("task.theta_rad", "east", "task.theta_rad: not a theta: 'east'"),
        ("sensing.dropout", None, "sensing.dropout: not a dropout: None"),
        ("task.obstacles", float("inf"), "task.obstacles: not a obstacles"),
    ],
)
def test_what_no_widget_can_show_is_refused_by_name(path: str, shown: object, complaint: str) -> None:
    with pytest.raises(InvalidInputError) as refused:
        from_screen(field_of(load_scenario("ur5_linear_obstacles"), path), shown)
    assert complaint in str(refused.value)


def test_a_value_left_to_the_seed_is_shown_and_taken_back_as_drawn() -> None:
    scenario = load_scenario("ur5_linear")
    angle = field_of(scenario, "task.theta_rad")
    assert on_screen(angle) == "drawn"
    assert from_screen(angle, " ") == from_screen(angle, "drawn") == "none"
    assert from_screen(angle, "90") == pytest.approx(1.5707963)
    pinned = with_overrides(scenario, ["task.theta_rad=1.5707963", "task.direction=-1"])
    assert on_screen(field_of(pinned, "task.theta_rad")) == "90"
    assert on_screen(field_of(pinned, "task.direction")) == "-1"


def test_units_are_those_of_the_names() -> None:
    assert split_unit("acceleration_std_mps2")[0] == "acceleration_std"
    assert split_unit("max_checks") == ("max_checks", split_unit("kind")[1])
    for unit in SUFFIXES.values():
        assert unit.si(unit.shown(0.3)) == pytest.approx(0.3, rel=1e-5)


def test_another_kind_or_method_takes_the_place_of_what_was_set_below() -> None:
    kept = {"object": "cube", "method.predictor.kind": "kalman", "method.predictor.measurement_std_m": 0.01}
    assert merged(kept, {"method.predictor.kind": "lstm"}) == {"object": "cube", "method.predictor.kind": "lstm"}
    assert merged(kept, {"method": "ours_rm"}) == {"object": "cube", "method": "ours_rm"}
    assert list(merged({"method": "ik", "object": "cube"}, {"method.filter.keep": 3}))[2] == "method.filter.keep"


def view(info: TrialInfo, session: Session) -> View:
    state = replace(session.state, info=info)
    return View(state, state, (), Tally(), None, "")


def test_the_method_panel_follows_the_kind_that_is_set(server: viser.ViserServer) -> None:
    engine = FakeEngine()
    session = Session(engine, Restart(scenario="ur5_linear", overrides={}))
    panel = MethodPanel(server.gui, Desk(server, session))

    def labels(**overrides: Any) -> list[str]:
        paths = {name.replace("__", "."): value for name, value in overrides.items()}
        info = engine.describe(Restart(scenario="ur5_linear", overrides=paths))
        panel.show(view(info, session))
        folder: Any = panel._folders["predictor"]  # pyright: ignore[reportPrivateUsage]
        return [widget.label for widget in folder._widgets]

    assert labels() == []
    assert labels(method__predictor__kind="kalman") == ["Acceleration std, cm/s²", "Measurement std, cm"]
    assert labels(method__predictor__kind="constant_velocity") == ["Window, s"]
    assert labels(method__predictor__kind="lstm") == []


def test_a_trial_that_begins_as_its_file_says_has_no_task_to_set(server: viser.ViserServer) -> None:
    scenario = load_scenario("ur5_linear")
    begun = scenario.model_copy(update={"start": start_of(setup_of_seed(scenario, 0))})
    session = Session(FakeEngine(), Restart(scenario="mine", file=to_toml(begun), overrides={}))
    with pytest.raises(InvalidInputError, match=r"\[start\]"):
        Desk(server, session).restart(overrides={"task.speed_mps": 0.03})
