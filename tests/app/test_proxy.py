"""Laws of the server's one port: what is served, who may talk, and what a viewer may say."""

from __future__ import annotations

import time
from collections.abc import Iterator

import httpx
import msgspec
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from app.inbound import is_allowed
from app.ui.start import start_viser
from tests.app.served import Served, serve, wait_for
from tests.app.viewer_client import ViewerClient, view

pytestmark = [pytest.mark.timeout(60), pytest.mark.xdist_group("served")]
TOKEN = "correct horse battery"


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--max-clients", "2") as server:
        yield server


@pytest.fixture(scope="module")
def locked() -> Iterator[Served]:
    with serve("--paused", "--token", TOKEN) as server:
        yield server


@pytest.fixture
def viewer(served: Served) -> Iterator[ViewerClient]:
    assert served.command(kind="restart", scenario="ur5_linear", seed=0).status_code == 202
    wait_for(served, tick=0, loading=False, scenario="ur5_linear", seed=0)
    with view(served.authority) as client:
        yield client


def test_the_address_leads_to_the_viewer_under_our_title(served: Served) -> None:
    answer = httpx.get(served.address, follow_redirects=True)
    assert answer.url.path == "/viewer/"
    assert "<title>Dynamic grasping</title>" in answer.text
    assert answer.headers["content-encoding"] == "gzip"


def test_the_page_has_an_icon_of_its_own(served: Served) -> None:
    page = httpx.get(served.address + "viewer/").text
    assert '<link rel="icon" type="image/svg+xml" href="/assets/icon.svg">' in page
    icon = httpx.get(served.address + "assets/icon.svg")
    assert icon.status_code == 200 and icon.text.startswith("<svg")


def test_a_viewer_gets_the_scene_through_the_proxy(viewer: ViewerClient) -> None:
    viewer.wait_for("MeshMessage", name="/object/body")
    viewer.wait_for("BatchedMeshesMessage", name="/grasps/predicted/shortlist")
    viewer.widget("GuiDropdownMessage", "Scenario")


def test_another_version_of_the_viewer_is_turned_away(served: Served) -> None:
    with connect(f"ws://{served.authority}/viewer", subprotocols=["viser-v0.0.1"], proxy=None) as socket:  # pyright: ignore[reportArgumentType]
        with pytest.raises(ConnectionClosed):
            while True:
                socket.recv(5.0)


def test_more_browsers_than_allowed_are_turned_away(served: Served) -> None:
    with view(served.authority) as one, view(served.authority) as two:
        one.wait_for("MeshMessage", name="/object/body")
        two.wait_for("MeshMessage", name="/object/body")
        with pytest.raises(ConnectionClosed, match="At most 2 browsers"), view(served.authority) as three:
            while True:
                three.receive()


@pytest.mark.parametrize(
    ("kind", "label", "value", "complaint"),
    [
        ("GuiNumberMessage", "Seed", -5, "seed: input should be greater than or equal to 0 (got -5)"),
        (
            "GuiSliderMessage",
            "Belt, cm/s",
            9900.0,
            "task.linear.speed_mps: input should be less than or equal to 0.5 (got 99",
        ),
        (
            "GuiDropdownMessage",
            "Scenario",
            "<b>nowhere</b>",
            "There is no scenario named '<b>nowhere</b>'. Available:",
        ),
        ("GuiDropdownMessage", "Compare with", "<b>best</b>", "There is no method named '<b>best</b>'. Available:"),
        ("GuiDropdownMessage", "Speed", "17", "There is no speed named '17'. Available: 1, 1/2, 1/4, 1/8"),
        ("GuiButtonGroupMessage", "Direction", "Up", "direction: choose one of Forth, Stop, Back (got 'Up')"),
        ("GuiButtonGroupMessage", "Time", "Explode", "There is no button named 'Explode'"),
    ],
)
def test_a_bad_value_is_refused_with_its_bound_and_changes_nothing(
    served: Served, viewer: ViewerClient, kind: str, label: str, value: object, complaint: str
) -> None:
    before = served.state()
    viewer.set(viewer.widget(kind, label), value)
    title, body = viewer.notice()
    assert title == "Not possible"
    assert complaint in body
    assert {**served.state(), "real_time_factor": 0.0} == {**before, "real_time_factor": 0.0}


def test_a_refused_value_is_taken_back_from_the_widget(viewer: ViewerClient) -> None:
    seed = viewer.widget("GuiNumberMessage", "Seed")
    viewer.set(seed, -5)
    viewer.notice()
    viewer.wait_for("GuiUpdateMessage", uuid=seed, updates={"value": 0})


def test_a_belt_speed_within_reach_acts_on_the_running_trial(served: Served, viewer: ViewerClient) -> None:
    run = served.state()["run"]
    viewer.set(viewer.widget("GuiSliderMessage", "Belt, cm/s"), -10.0)
    assert viewer.notice() == ("Done", "Belt set to -10.0 cm/s in the running trial.")
    served.command(kind="step_once")
    assert wait_for(served, belt_rate=-2.0)["run"] == run


def test_a_belt_speed_beyond_reach_restarts_and_says_so(served: Served, viewer: ViewerClient) -> None:
    run = served.state()["run"]
    assert isinstance(run, int)
    viewer.set(viewer.widget("GuiSliderMessage", "Belt, cm/s"), 40.0)
    assert viewer.notice() == ("Done", "Restarted with belt speed 40.0 cm/s.")
    state = wait_for(served, run=run + 1, loading=False)
    assert state["overrides"] == {"task.speed_mps": 0.4}


def test_an_object_or_method_restarts_the_trial_and_says_so(served: Served, viewer: ViewerClient) -> None:
    viewer.set(viewer.widget("GuiDropdownMessage", "Object"), "cube")
    assert viewer.notice() == ("Done", "Restarted with object cube.")
    wait_for(served, object="cube", loading=False)
    viewer.set(viewer.widget("GuiDropdownMessage", "Method"), "baseline")
    assert viewer.notice() == ("Done", "Restarted with method baseline.")
    wait_for(served, object="cube", method="baseline", loading=False)


def test_nobody_opens_a_tunnel_to_the_outside(viewer: ViewerClient) -> None:
    viewer.send("ShareUrlRequest")
    viewer.widget("GuiNumberMessage", "Seed")
    assert not any(message["type"] == "ShareUrlUpdated" for message in viewer.messages)
    server = start_viser()
    assert server.request_share_url() is None
    server.stop()


@pytest.mark.parametrize(
    "message",
    [
        {"type": "ShareUrlRequest"},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"update_cb": []}},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": 1, "removed": True}},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": float("nan")}},
        {"type": "FileTransferStartUpload"},
        ["no", "map"],
    ],
)
def test_messages_no_viewer_needs_are_dropped(message: object) -> None:
    assert not is_allowed(msgspec.msgpack.encode(message))
    assert not is_allowed(b"\xc1 not msgpack")


def test_a_foreign_page_gets_nothing(served: Served) -> None:
    with pytest.raises(InvalidStatus, match="403"), view(served.authority, Origin="http://evil.example"):
        pass
    answer = httpx.post(
        served.address + "api/v1/session/commands",
        json={"kind": "step_once"},
        headers={"Origin": "http://evil.example"},
    )
    assert answer.status_code == 403 and "another site" in answer.json()["error"]
    with view(served.authority, Origin=f"http://{served.authority}") as own:
        own.wait_for("MeshMessage", name="/object/body")


def test_a_foreign_name_for_this_machine_gets_nothing(served: Served) -> None:
    answer = httpx.get(served.address + "api/v1/health", headers={"Host": "evil.example"})
    assert answer.status_code == 403 and "localhost" in answer.json()["error"]


def test_without_the_token_nothing_is_served(locked: Served) -> None:
    for path in ("", "viewer/", "api/v1/session", "assets/x"):
        answer = httpx.get(locked.address + path)
        assert answer.status_code == 401 and "?token=" in answer.json()["error"]
    with pytest.raises(InvalidStatus, match="403"), view(locked.authority):
        pass
    wrong = httpx.get(locked.address, params={"token": TOKEN + "x"})
    assert wrong.status_code == 401


def test_the_token_is_needed_once_and_leaves_the_address_bar(locked: Served) -> None:
    with httpx.Client(follow_redirects=True) as browser:
        answer = browser.get(locked.address, params={"token": TOKEN})
        assert answer.status_code == 200 and "token" not in str(answer.url)
        assert browser.get(locked.address + "api/v1/health").json()["server"] == "ok"
        cookie = "; ".join(f"{name}={value}" for name, value in browser.cookies.items())
    with view(locked.authority, Cookie=cookie) as client:
        client.wait_for("MeshMessage", name="/object/body")
    bearer = httpx.get(locked.address + "api/v1/health", headers={"Authorization": f"Bearer {TOKEN}"})
    assert bearer.status_code == 200


def test_the_api_lists_what_exists(served: Served) -> None:
    answer = httpx.get(served.address + "api/v1/scenarios").json()
    assert [entry["scenario"] for entry in answer["scenarios"]] == [
        "ur5_linear",
        "ur5_linear_slab",
        "mico_varying",
        "boom",
    ]
    assert "cube" in answer["objects"] and "baseline" in answer["methods"]


@pytest.mark.parametrize(
    ("fields", "status", "complaint"),
    [
        (
            {"kind": "restart", "scenario": "nowhere"},
            404,
            "There is no scenario named 'nowhere'. Available: boom",
        ),
        ({"kind": "set_speed", "speed": 99}, 422, "less than or equal to 8"),
        (
            {"kind": "restart", "scenario": "ur5_linear", "overrides": {"task.speed_mps": 7.0}},
            422,
            "less than or equal to 0.5",
        ),
        ({"kind": "fly"}, 422, "set_paused"),
    ],
)
def test_the_api_refuses_with_the_reason(
    served: Served, fields: dict[str, object], status: int, complaint: str
) -> None:
    answer = served.command(**fields)
    assert answer.status_code == status
    assert complaint in answer.json()["error"]


def test_the_api_refuses_numbers_that_are_none(served: Served) -> None:
    answer = httpx.post(
        served.address + "api/v1/session/commands",
        content='{"kind": "set_speed", "speed": NaN}',
        headers={"Content-Type": "application/json"},
    )
    assert answer.status_code == 422 and "finite" in answer.json()["error"]


@pytest.mark.parametrize("value", [None, -1, 2**63, "<b>", "", [], ["a"], {"x": 1}, True, b"raw"])
def test_no_value_of_any_widget_breaks_the_page(served: Served, viewer: ViewerClient, value: object) -> None:
    for kind, label in (("Number", "Hold, s"), ("Number", "Latency, s"), ("Slider", "Time, s")):
        viewer.widget(f"Gui{kind}Message", label)
    kinds = ("Number", "Slider", "Dropdown", "Checkbox", "Text", "ButtonGroup", "UploadButton")
    names = {f"Gui{kind}Message" for kind in kinds}
    widgets = [str(m["uuid"]) for m in viewer.messages if m["type"] in names]
    assert len(widgets) > 30
    for uuid in widgets:
        viewer.set(uuid, value)
    time.sleep(1.5)
    served.command(kind="set_paused", paused=True)
    served.command(kind="restart", scenario="ur5_linear_slab", seed=4)
    assert wait_for(served, scenario="ur5_linear_slab", seed=4, loading=False)["simulation"] == "running"
    with view(served.authority) as other:
        other.widget("GuiSliderMessage", "Time, s")
