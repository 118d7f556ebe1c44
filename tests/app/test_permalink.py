"""Laws of links and files: what was shared is what is opened, and what cannot be opened is explained."""

from __future__ import annotations

import base64
import json
import tomllib
import zlib
from collections.abc import Iterator

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.commands import LARGEST_FILE_CHARS, OverrideValue, Restart
from app.inbound import is_allowed
from app.permalink import PARTS, address_of, trial_at
from app.wanted import read_scenario, scenario_of
from backend.errors import GraspingError, InvalidInputError, NotFoundError
from backend.events import MoveObstacle, SetBeltRate, TimedEvent
from backend.scenario import load_scenario, to_toml
from tests.app.served import Served, serve, wait_for

EVENTS = st.builds(
    TimedEvent,
    tick=st.integers(0, 5000),
    event=st.one_of(
        st.builds(SetBeltRate, rate=st.floats(-4.0, 4.0)),
        st.builds(MoveObstacle, index=st.integers(0, 15), x_m=st.floats(-2.0, 2.0), y_m=st.floats(-2.0, 2.0)),
    ),
)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
VALUES: st.SearchStrategy[OverrideValue] = st.one_of(st.booleans(), st.integers(-(2**53), 2**53), NUMBERS, st.text())
TRIALS = st.builds(
    Restart,
    scenario=st.text(min_size=1, max_size=100),
    seed=st.integers(0, 2**31 - 1),
    overrides=st.dictionaries(st.text(min_size=1), VALUES, max_size=5),
    events=st.lists(EVENTS, max_size=5).map(tuple),
    compare=st.none() | st.text(min_size=1, max_size=100),
    file=st.none() | st.text(max_size=500),
)


@given(TRIALS)
def test_a_link_leads_to_the_trial_it_was_made_of(trial: Restart) -> None:
    query = dict(httpx.URL("http://x" + address_of(trial)).params)
    assert trial_at(query) == trial


@pytest.mark.parametrize(
    ("query", "complaint"),
    [
        ({"scenario": "ur5_linear", "sed": "1"}, "link: sed: no such part. There are scenario, seed"),
        ({}, "link: scenario: string should have at least 1 character"),
        ({"scenario": "x", "seed": "-1"}, "link: seed: input should be a valid integer"),
        ({"scenario": "x", "set": "{"}, "link: set: not JSON"),
        ({"scenario": "x", "set": "[" * 100_000}, "link: set: not JSON"),
        ({"scenario": "x", "set": '{"a": null}'}, "link: overrides.a"),
        ({"scenario": "x", "edits": '[{"tick": 1, "event": {"kind": "fly"}}]'}, "link: events.0.event"),
        ({"scenario": "x", "file": "!"}, "link: file: cannot be unpacked"),
        ({"scenario": "x", "file": base64.urlsafe_b64encode(zlib.compress(b"a" * 10**8)).decode()}, "longer than"),
        ({"scenario": "x", "file": base64.urlsafe_b64encode(zlib.compress(b"\xff")).decode()}, "cannot be unpacked"),
    ],
)
def test_a_link_that_cannot_be_used_says_which_part(query: dict[str, str], complaint: str) -> None:
    with pytest.raises(InvalidInputError) as refused:
        trial_at(query)
    assert complaint in str(refused.value)


@given(st.dictionaries(st.sampled_from(list(PARTS)), st.text(max_size=300)))
def test_no_link_breaks_anything(query: dict[str, str]) -> None:
    try:
        trial_at(query)
    except GraspingError as refused:
        assert str(refused)


@pytest.mark.parametrize("name", ["../pyproject.toml", "/etc/passwd", "scenarios/ur5_linear.toml", "ur5_linear.toml"])
def test_a_name_from_outside_is_never_a_path(name: str) -> None:
    with pytest.raises(NotFoundError, match="no scenario named"):
        scenario_of(Restart(scenario=name, overrides={}))


def test_a_brought_file_is_the_scenario_it_says_with_edits_on_top() -> None:
    text = to_toml(load_scenario("mico_linear_slab"))
    edits = (TimedEvent(tick=3, event=SetBeltRate(rate=2.0)),)
    wanted = scenario_of(Restart(scenario="mine", file=text, overrides={"task.slab_height_m": 0.5}, events=edits))
    assert (wanted.robot, wanted.task.kind, wanted.events) == ("mico", "linear_slab", edits)
    assert wanted.model_dump()["task"]["slab_height_m"] == 0.5


def test_a_complaint_about_one_edit_does_not_recite_the_others() -> None:
    with pytest.raises(InvalidInputError) as refused:
        scenario_of(Restart(scenario="ur5_linear", overrides={"object": "cube", "task.speed_mps": 3.0}))
    assert str(refused.value) == "task.linear.speed_mps: input should be less than or equal to 0.5 (got 3.0)"


def test_uploads_are_bounded_before_viser_sees_them() -> None:
    import msgspec

    def allowed(**message: object) -> bool:
        return is_allowed(msgspec.msgpack.encode(message))

    ids = {"source_component_uuid": "a", "transfer_uuid": "b"}
    start = {"type": "FileTransferStartUpload", **ids, "mime_type": "", "filename": "a.toml"}
    start |= {"size_bytes": 100, "part_count": 1}
    assert allowed(**start) and not allowed(**{**start, "size_bytes": 10**9})
    assert not allowed(**{**start, "part_count": 1000}) and not allowed(**{**start, "filename": "a" * 1000})
    part = {"type": "FileTransferPart", **ids, "part_index": 0, "content": b"title"}
    assert (
        allowed(**part)
        and not allowed(**{**part, "content": b"a" * 10**6})
        and not allowed(**{**part, "part_index": 7})
    )


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


def get(served: Served, path: str, **headers: str) -> httpx.Response:
    return httpx.get(served.address.rstrip("/") + path, headers=headers, timeout=10.0)


def test_opening_a_link_begins_its_trial_and_leads_to_the_page(served: Served) -> None:
    trial = Restart(
        scenario="ur5_linear_slab",
        seed=7,
        overrides={"object": "sugar_box"},
        events=(TimedEvent(tick=0, event=SetBeltRate(rate=3.0)),),
    )
    answer = get(served, address_of(trial))
    assert (answer.status_code, answer.headers["location"]) == (303, "/viewer/")
    state = wait_for(served, scenario="ur5_linear_slab", seed=7, object="sugar_box", tick=0, live_edits=1)
    assert state["loading"] is False
    served.command(kind="step_once")
    assert wait_for(served, tick=1)["belt_rate"] == 3.0


def test_a_link_that_cannot_be_opened_is_explained_on_a_page_of_its_own(served: Served) -> None:
    before = served.state()["run"]
    answer = get(served, "/open?scenario=<b>nowhere</b>")
    assert answer.status_code == 404 and "cannot be opened" in answer.text
    assert "&lt;b&gt;nowhere" in answer.text and "<b>nowhere" not in answer.text
    assert get(served, "/open?scenario=ur5_linear&seed=x").status_code == 422
    assert get(served, "/open?scenario=ur5_linear", **{"Sec-Fetch-Dest": "image"}).status_code == 403
    assert served.state()["run"] == before


def test_the_scenario_downloaded_is_the_trial_shown(served: Served) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=5, overrides={"task.speed_mps": 0.04})
    wait_for(served, scenario="ur5_linear", seed=5, tick=0, loading=False)
    served.command(kind="apply_event", event={"kind": "set_belt_rate", "rate": -1.0})
    wait_for(served, live_edits=1)
    answer = get(served, "/api/v1/session/scenario.toml")
    assert answer.headers["content-disposition"] == 'attachment; filename="ur5_linear_seed5.toml"'
    scenario = read_scenario(answer.text, "downloaded")
    assert (scenario.seed, scenario.model_dump()["task"]["speed_mps"]) == (5, 0.04)
    assert scenario.events == (TimedEvent(tick=0, event=SetBeltRate(rate=-1.0)),)
    assert tomllib.loads(answer.text)["object"] == "sugar_box"


def test_what_a_trial_leaves_can_be_had_once_it_has_ended(served: Served) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=0, overrides={})
    wait_for(served, seed=0, tick=0, loading=False)
    assert get(served, "/api/v1/session/trace.npz").status_code == 404
    assert "has not ended" in get(served, "/api/v1/session/outcome.json").json()["error"]
    served.command(kind="set_speed", speed=None)
    served.command(kind="set_paused", paused=False)
    wait_for(served, tick=600)
    assert get(served, "/api/v1/session/trace.npz").content == b"a trace of ours_rm"
    assert json.loads(get(served, "/api/v1/session/outcome.json").text)["seed"] == 0
    served.command(kind="set_speed", speed=1.0)
    served.command(kind="set_paused", paused=True)


def test_what_the_one_compared_with_leaves_can_be_had_as_well(served: Served) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=0, compare="baseline")
    wait_for(served, seed=0, tick=0, loading=False)
    served.command(kind="set_speed", speed=None)
    served.command(kind="set_paused", paused=False)
    wait_for(served, tick=600)
    answer = get(served, "/api/v1/session/trace.npz?compared=true")
    assert answer.content == b"a trace of baseline" and "seed0_compared.npz" in answer.headers["content-disposition"]
    assert get(served, "/api/v1/session/trace.npz").content == b"a trace of ours_rm"
    both = get(served, "/api/v1/session/replay.html")
    served.command(kind="set_speed", speed=1.0)
    served.command(kind="set_paused", paused=True)
    assert both.status_code == 200 and "__VISER_EMBED_DATA__" in both.text


def test_a_file_that_is_too_long_is_refused_by_the_command_itself(served: Served) -> None:
    answer = served.command(kind="restart", scenario="x", file="a" * (LARGEST_FILE_CHARS + 1))
    assert answer.status_code == 422 and "at most 65536 characters" in answer.json()["error"]
    answer = served.command(kind="restart", scenario="mine", file='title = "x"\nrobot = "ur6"')
    assert answer.status_code == 422 and "mine: robot: There is no robot named 'ur6'" in answer.json()["error"]


def test_the_replay_plays_without_the_server(served: Served) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=0, overrides={})
    wait_for(served, seed=0, tick=0, loading=False)
    served.command(kind="step_once")
    wait_for(served, tick=1)
    answer = get(served, "/api/v1/session/replay.html")
    assert answer.status_code == 200 and "ur5_linear_seed0.html" in answer.headers["content-disposition"]
    assert "__VISER_EMBED_DATA__" in answer.text and "<html" in answer.text
