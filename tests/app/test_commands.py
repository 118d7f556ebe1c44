"""Laws of commands and settings: what is written is checked where it enters."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.commands import SPEEDS, ApplyEvent, Restart, SetPaused, SetSpeed, StepOnce, read_command
from app.settings import Settings, read_settings
from backend.errors import InvalidInputError
from backend.events import MoveObstacle, SetBeltRate

COMMANDS = [
    SetPaused(paused=True),
    StepOnce(),
    SetSpeed(speed=0.5),
    SetSpeed(speed=None),
    Restart(scenario="ur5_linear", seed=3, overrides={"task.speed_mps": 0.03, "object": "cube"}),
    ApplyEvent(event=SetBeltRate(rate=-1.5)),
    ApplyEvent(event=MoveObstacle(index=1, x_m=0.2, y_m=-0.3)),
]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c.kind)
def test_a_command_survives_json(command: Restart) -> None:
    assert read_command(command.model_dump_json()) == command


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            '{"kind": "set_speed", "speed": 9}',
            "set_speed.speed: input should be less than or equal to 8 (got 9)",
        ),
        (
            '{"kind": "restart", "scenario": "x", "seed": -1}',
            "restart.seed: input should be greater than or equal to 0",
        ),
        ('{"kind": "restart", "scenario": "x", "sed": 1}', "restart.sed: extra inputs are not permitted"),
        ('{"kind": "fly"}', "'set_paused', 'step_once', 'set_speed', 'restart', 'apply_event'"),
        ('{"kind": "apply_event", "event": {"kind": "set_belt_rate", "rate": 5}}', "less than or equal to 4"),
        ('{"kind": "set_paused", "paused": "yes"}', "set_paused.paused: input should be a valid boolean"),
        ("[1, 2", "Invalid JSON"),
    ],
)
def test_a_bad_command_names_key_and_bound(text: str, complaint: str) -> None:
    with pytest.raises(InvalidInputError) as refused:
        read_command(text)
    assert complaint in str(refused.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_no_number_that_is_none_passes(value: float) -> None:
    event = {"kind": "set_belt_rate", "rate": value}
    for fields in ({"kind": "set_speed", "speed": value}, {"kind": "apply_event", "event": event}):
        with pytest.raises(InvalidInputError, match="finite number"):
            read_command(json.dumps(fields))
    with pytest.raises(InvalidInputError, match="finite number"):
        read_command(json.dumps({"kind": "restart", "scenario": "x", "overrides": {"task.speed_mps": value}}))


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_speeds_outside_the_offered_range_are_refused(speed: float) -> None:
    inside = SPEEDS[0] <= speed <= SPEEDS[-1]
    try:
        read_command(json.dumps({"kind": "set_speed", "speed": speed}))
    except InvalidInputError:
        assert not inside
    else:
        assert inside


def test_flags_win_over_the_environment_and_that_over_defaults() -> None:
    environment = {
        "GRASPING_PORT": "9000",
        "GRASPING_SEED": "4",
        "GRASPING_PAUSED": "1",
        "GRASPING_TOKEN": "",
    }
    settings = read_settings(["--port", "9001", "--no-auto-next"], environment)
    assert (settings.port, settings.seed, settings.paused, settings.auto_next) == (9001, 4, True, False)
    assert settings.host == "127.0.0.1" and settings.token is None


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--port", "http"], "settings: port: input should be a valid integer"),
        (["--port", "70000"], "settings: port: input should be less than or equal to 65535 (got '70000')"),
        (["--seed", "nan"], "settings: seed: input should be a valid integer"),
        (
            ["--host", "0.0.0.0"],
            "listening on 0.0.0.0 lets other machines in, so a token is needed: add --token",
        ),
        (["--token", "short"], "settings: token: string should have at least 8 characters"),
    ],
)
def test_bad_settings_name_flag_and_bound(arguments: list[str], complaint: str) -> None:
    with pytest.raises(InvalidInputError) as refused:
        read_settings(arguments, {})
    assert complaint in str(refused.value)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.2", "localhost", "::1"])
def test_only_this_machine_is_served_without_a_token(host: str) -> None:
    assert Settings(host=host).token is None
    assert Settings(host="192.168.1.7", token="long enough").host == "192.168.1.7"
