"""Laws of the event stream and of what scripts can do: all that the page can, and they are told what comes of it."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Iterator
from typing import Any, get_args

import httpx
import pytest

from app.api.events import MOST_STREAMS, changes
from app.api.examples import COMMANDS
from app.commands import Command, Restart, SetPaused, read_command
from app.session import Session
from app.wanted import scenario_of
from tests.app.served import Served, serve, wait_for
from tests.app.sessions import tick, wait

pytestmark = [pytest.mark.timeout(90), pytest.mark.xdist_group("served")]


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


class Stream:
    """Reads server-sent events."""

    def __init__(self, answer: httpx.Response) -> None:
        self._lines = answer.iter_lines()

    def next(self) -> dict[str, Any]:
        """The next event, its data read; a comment is an event of that kind."""
        fields: dict[str, Any] = {}
        for line in self._lines:
            if not line and fields:
                return fields
            name, _, value = line.partition(":")
            if name in ("", "event", "data", "id", "retry"):
                fields[name or "comment"] = json.loads(value) if name == "data" else value.strip()
        raise StopIteration

    def until(self, kind: str, **wanted: object) -> dict[str, Any]:
        """The data of the next event of that kind with those values."""
        while True:
            event = self.next()
            if event.get("event") == kind and all(event["data"][key] == value for key, value in wanted.items()):
                return event["data"]


def test_what_happens_is_told_and_who_drives(served: Served) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=0)
    wait_for(served, tick=0, loading=False, seed=0)
    with httpx.stream("GET", served.address + "api/v1/events", timeout=10.0) as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        stream = Stream(answer)
        assert stream.until("control")["visitors"] == 0
        assert stream.until("state")["tick"] == 0
        httpx.post(served.address + "api/v1/session/driver")
        assert stream.until("control", driver="A script")["you_drive"] is True
        served.command(kind="step_once")
        stream.until("state", tick=1)
        served.command(kind="apply_event", event={"kind": "set_belt_rate", "rate": -1.0})
        stream.until("state", live_edits=1)
        httpx.patch(served.address + "api/v1/session/view", json={"grasps_by": "Reachability"})
        assert stream.until("view", grasps_by="Reachability")["hidden"] == ["Reach"]
        served.command(kind="restart", scenario="mico_varying", seed=5)
        stream.until("state", scenario="mico_varying", seed=5, tick=0, loading=False)


def test_no_more_events_come_than_were_asked_for(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(SetPaused(paused=False))
    assert len([each for each in collect(session, 0.1, 2.0) if each == "state"]) <= 21
    session.send(SetPaused(paused=True))
    wait(session, lambda s: s.pace.paused and s.pace.real_time_factor == 0.0)
    quiet = collect(session, 0.1, 1.0, heartbeat_s=0.2)
    assert quiet[:3] == ["control", "state", "view"] and 3 <= quiet.count(None) <= 5
    assert len(quiet) == 3 + quiet.count(None)


def collect(session: Session, interval_s: float, for_s: float, heartbeat_s: float = 60.0) -> list[str | None]:
    """Kinds of the events in that time; None is a comment."""

    async def gather() -> list[str | None]:
        kinds: list[str | None] = []
        asyncio.get_running_loop().call_later(for_s, session.closing.set)
        async for event in changes(session, interval_s, heartbeat_s):
            kinds.append(event.event)
        session.closing.clear()
        return kinds

    return asyncio.run(gather())


def test_streams_are_bounded_and_a_closed_one_makes_room(served: Served) -> None:
    address = served.address + "api/v1/events"
    with httpx.Client(timeout=10.0, limits=httpx.Limits(max_connections=100)) as client:
        streams = [client.send(client.build_request("GET", address), stream=True) for _ in range(MOST_STREAMS)]
        assert {stream.status_code for stream in streams} == {200}
        refused = client.get(address)
        assert refused.status_code == 429 and "close one" in refused.json()["error"]
        for stream in streams:
            stream.close()
        deadline = time.monotonic() + 10.0
        while True:
            with client.stream("GET", address) as again:
                if again.status_code == 200:
                    return
            assert time.monotonic() < deadline


@pytest.mark.parametrize("rate", ["0", "-1", "31", "nan", "inf", "x", ""])
def test_a_rate_out_of_bounds_is_refused(served: Served, rate: str) -> None:
    answer = httpx.get(served.address + "api/v1/events", params={"rate_hz": rate})
    assert answer.status_code == 422 and "rate_hz" in answer.json()["error"]


def test_a_stream_ends_when_the_server_does_and_keeps_it_from_nothing() -> None:
    with serve("--paused") as server:
        with httpx.stream("GET", server.address + "api/v1/events?rate_hz=0.1", timeout=20.0) as answer:
            lines = answer.iter_lines()
            next(lines)
            begin_s = time.monotonic()
            server.process.terminate()
            for _ in lines:
                pass
            assert time.monotonic() - begin_s < 5.0
        server.process.wait(20.0)


def test_every_command_has_an_example_and_every_example_can_be_run(served: Served) -> None:
    commands = [read_command(json.dumps(example.get("value"))) for example in COMMANDS.values()]
    assert {type(command) for command in commands} == set(get_args(get_args(Command)[0]))
    for command in commands:
        if isinstance(command, Restart):
            scenario_of(command)
    described = httpx.get(served.address + "api/openapi.json").json()
    body = described["paths"]["/api/v1/session/commands"]["post"]["requestBody"]["content"]["application/json"]
    assert set(body["examples"]) == set(COMMANDS)
    assert all(path.startswith("/api/v1/") for path in described["paths"])
    assert all("summary" in each for methods in described["paths"].values() for each in methods.values())


def test_a_script_does_all_that_the_page_does(served: Served) -> None:
    api = served.address + "api/v1/session/"
    with httpx.Client(base_url=api, timeout=10.0) as script:

        def ask(**fields: object) -> None:
            assert script.post("commands", json=fields).status_code == 202, fields

        script.post("driver")
        ask(kind="restart", scenario="ur5_linear", seed=2, overrides={"object": "cube", "task.speed_mps": 0.04})
        wait_for(served, seed=2, object="cube", tick=0, loading=False)
        ask(kind="apply_event", event={"kind": "move_obstacle", "index": 0, "x_m": 0.5, "y_m": 0.1})
        ask(kind="set_speed", speed=2.0)
        ask(kind="set_paused", paused=False)
        deadline = time.monotonic() + 20.0
        while int(str(served.state()["tick"])) < 30:
            assert time.monotonic() < deadline
        ask(kind="set_paused", paused=True)
        ask(kind="look_back", t_s=0.5)
        state = served.state()
        assert 0.0 < float(str(state["looked_at_s"])) < float(str(state["t_s"]))
        ask(kind="go_on")
        ask(kind="set_paused", paused=True)
        ask(kind="set_speed", speed=1.0)
        assert served.state()["live_edits"] == 1
        assert script.get("scenario.toml").status_code == 200
        script.delete("driver")
