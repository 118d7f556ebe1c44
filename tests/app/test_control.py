"""Laws of several people at one server, without a browser: one drives, and watchers change nothing."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from tests.app.served import Served, serve, wait_for
from tests.app.viewer_client import ViewerClient, view

pytestmark = [pytest.mark.timeout(60), pytest.mark.xdist_group("served")]


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


@pytest.fixture(autouse=True)
def fresh_trial(served: Served) -> None:
    assert served.command(kind="set_paused", paused=True).status_code == 202
    assert served.command(kind="restart", scenario="ur5_linear", seed=0).status_code == 202
    wait_for(served, tick=0, loading=False, seed=0)


def who(served: Served, **headers: str) -> dict[str, object]:
    return httpx.get(served.address + "api/v1/session/driver", headers=headers).json()


def pages(served: Served, count: int) -> None:
    """Wait until so many pages are open."""
    deadline = 400
    while who(served)["visitors"] != count:
        deadline -= 1
        assert deadline, who(served)


def line(viewer: ViewerClient, text: str) -> None:
    """Wait until the page's own line has this in it."""

    def has(message: dict[str, object]) -> bool:
        return text in str(message.get("props", message.get("updates")))

    while not any(has(message) for message in viewer.messages if str(message["type"]).startswith("Gui")):
        viewer.receive(5.0)


def key_of(viewer: ViewerClient) -> str:
    """The key that the page's script would read off the line."""
    line(viewer, "data-visitor")
    found = next(str(m) for m in viewer.messages if "data-visitor" in str(m))
    return found.split('data-visitor="')[1].split('"')[0]


def test_a_watchers_control_is_answered_and_put_back_and_changes_nothing(served: Served) -> None:
    with view(served.authority) as driver:
        line(driver, "you drive")
        with view(served.authority) as watcher:
            line(watcher, "you watch")
            line(driver, "1 watches")
            before = served.state()
            seed = watcher.widget("GuiNumberMessage", "Seed")
            driver.messages.clear()
            watcher.set(seed, 7)
            title, body = watcher.notice()
            assert title == "Not possible" and "drives and you watch" in body and "Take control" in body
            watcher.wait_for("GuiUpdateMessage", uuid=seed, updates={"value": 0})
            assert served.state() == before
            assert not any(m["type"] == "NotificationShowMessage" for m in driver.messages)
            driver.set(seed, 3)
            wait_for(served, seed=3, loading=False)
            watcher.wait_for("GuiUpdateMessage", uuid=seed, updates={"value": 3})


def test_a_watcher_takes_control_and_the_former_driver_is_told(served: Served) -> None:
    with view(served.authority) as first, view(served.authority) as second:
        line(first, "you drive")
        line(second, "you watch")
        second.set(second.widget("GuiButtonMessage", "Take control"), True)
        title, body = first.notice()
        assert title == "Control" and body.endswith("drives now.")
        line(second, "you drive")
        first.set(first.widget("GuiNumberMessage", "Seed"), 9)
        assert first.notice()[0] == "Not possible"
        second.set(second.widget("GuiNumberMessage", "Seed"), 4)
        wait_for(served, seed=4, loading=False)


def test_an_edit_that_waits_for_its_typing_to_end_is_not_lost_to_a_watchers(served: Served) -> None:
    with view(served.authority) as driver, view(served.authority) as watcher:
        line(driver, "you drive")
        line(watcher, "you watch")
        seed = driver.widget("GuiNumberMessage", "Seed")
        driver.set(seed, 5)
        watcher.set(seed, 6)
        wait_for(served, seed=5, loading=False)


def test_when_the_driver_leaves_the_next_to_use_a_control_drives(served: Served) -> None:
    with view(served.authority) as second, view(served.authority) as third:
        line(third, "you watch")
        with view(served.authority) as other:
            line(other, "you watch")
            other.set(other.widget("GuiButtonMessage", "Take control"), True)
            line(other, "you drive")
        pages(served, 2)
        assert who(served)["driver"] is None
        third.set(third.widget("GuiNumberMessage", "Seed"), 8)
        wait_for(served, seed=8, loading=False)
        line(second, "you watch")


def test_a_script_needs_control_while_a_visitor_drives_and_gives_it_back(served: Served) -> None:
    api = served.address + "api/v1/session/"
    with view(served.authority) as visitor:
        line(visitor, "you drive")
        refused = httpx.post(api + "commands", json={"kind": "step_once"})
        assert refused.status_code == 409
        assert "drives and you watch" in refused.json()["error"] and "session/driver" in refused.json()["error"]
        assert served.state()["tick"] == 0
        assert httpx.post(api + "driver").json() == {
            "driver": "A script",
            "visitors": 1,
            "watching": 1,
            "you_drive": True,
        }
        assert httpx.post(api + "commands", json={"kind": "step_once"}).status_code == 202
        wait_for(served, tick=1)
        line(visitor, "A script drives")
        visitor.set(visitor.widget("GuiNumberMessage", "Seed"), 2)
        visitor.notice_saying("A script drives")
        assert httpx.delete(api + "driver").json()["you_drive"] is False
        line(visitor, "you drive")


def test_a_pages_own_requests_count_as_its_own(served: Served) -> None:
    api = served.address + "api/v1/session/"
    with view(served.authority) as driver, view(served.authority) as watcher:
        line(driver, "you drive")
        mine, other = {"X-Visitor": key_of(driver)}, {"X-Visitor": key_of(watcher)}
        assert who(served, **mine)["you_drive"] is True and who(served, **other)["you_drive"] is False
        step = {"kind": "step_once"}
        assert httpx.post(api + "commands", json=step, headers=other).status_code == 409
        assert httpx.post(api + "commands", json=step, headers=mine).status_code == 202
        wait_for(served, tick=1)


def test_a_link_restarts_what_somebody_else_drives_only_when_that_is_wanted(served: Served) -> None:
    link = served.address + "open?scenario=ur5_linear_slab&seed=6"
    with view(served.authority) as driver:
        line(driver, "you drive")
        asked = httpx.get(link)
        assert asked.status_code == 409 and "drives just now" in asked.text and 'method="post"' in asked.text
        assert served.state()["seed"] == 0
        own = httpx.get(link, headers={"Cookie": f"grasping_visitor={key_of(driver)}"})
        assert own.status_code == 303
        wait_for(served, scenario="ur5_linear_slab", seed=6, loading=False)
    with view(served.authority) as driver:
        line(driver, "you drive")
        evil = {"Origin": "http://evil.example"}
        assert httpx.post(link.replace("seed=6", "seed=1"), headers=evil).status_code == 403
        taken = httpx.post(link.replace("seed=6", "seed=2"))
        assert taken.status_code == 303 and taken.headers["location"] == "/viewer/"
        wait_for(served, seed=2, loading=False)
        with view(served.authority) as newcomer:
            line(newcomer, "you drive")
            line(driver, "you watch")


def drag(viewer: ViewerClient, name: str) -> None:
    """Push a thing about by 10 cm."""
    for phase, shift_m in (("start", 0.0), ("update", 0.05), ("end", 0.1)):
        viewer.send(
            "SceneNodeDragMessage",
            phase=phase,
            name=name,
            instance_index=None,
            start_position=[0.65, -0.3, 0.05],
            start_screen_pos=[0.5, 0.5],
            end_position=[0.65 + shift_m, -0.3, 0.05],
            end_screen_pos=[0.5, 0.5],
            button="left",
            modifier=None,
        )


def test_a_watcher_pushes_nothing_about_and_hides_nothing(served: Served) -> None:
    with view(served.authority) as driver, view(served.authority) as watcher:
        line(driver, "you drive")
        line(watcher, "you watch")
        driver.wait_for("MeshMessage", name="/obstacles/0")
        obstacles = watcher.widget("GuiCheckboxMessage", "Obstacles")
        driver.messages.clear()
        watcher.set(obstacles, False)
        watcher.wait_for("GuiUpdateMessage", uuid=obstacles, updates={"value": True})
        drag(watcher, "/obstacles/0")
        watcher.notice_saying("you watch")
        driver.receive()
        about = [message for message in driver.messages if message.get("name", "").startswith("/obstacles")]
        assert not any(message.get("visible") is False for message in about)
        places = [message["position"][0] for message in about if message["type"] == "SetPositionMessage"]
        assert places == pytest.approx([0.65] * len(places)) and served.state()["live_edits"] == 0
        drag(driver, "/obstacles/0")
        wait_for(served, live_edits=1)
        driver.set(obstacles, False)
        watcher.wait_for("SetSceneNodeVisibilityMessage", name="/obstacles", visible=False)
        driver.set(obstacles, True)
