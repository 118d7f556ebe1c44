"""Laws of the shared view: one value, the same for every page and every script."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.examples import VIEWS
from app.commands import Restart
from app.session import Session
from app.ui.desk import checked
from app.ui.layers import LAYERS
from app.ui.scores import SCORES
from app.view import LayerName, SharedView
from backend.errors import InvalidInputError
from backend.knowledge.reach_profile import GRASP_KINDS, HIGHEST_M
from tests.app.fake_episode import LINEAR, FakeEngine
from tests.app.served import Served, begin_anew, play_to, serve, wait_for
from tests.app.viewer_client import ViewerClient, view

pytestmark = [pytest.mark.timeout(60), pytest.mark.xdist_group("served")]
TITLES = [layer.title for layer in LAYERS]
LAST_SEED = 2**31 - 1
PLAIN: dict[str, object] = {
    "auto_next": False,
    "grasps_by": "Rank",
    "grasp": None,
    "hidden": [],
    "reach_of": "From above",
    "reach_height_m": 0.1,
}
"""What the server below shows at first."""


def test_layers_and_scores_have_the_names_of_the_page_and_its_order() -> None:
    fields = SharedView.model_json_schema()["properties"]
    assert fields["hidden"]["items"]["enum"] == TITLES
    assert fields["grasps_by"]["enum"] == list(SCORES)


NAMES: st.SearchStrategy[LayerName] = st.sampled_from(TITLES)  # pyright: ignore[reportAssignmentType]
CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "auto_next": st.booleans(),
        "grasps_by": st.sampled_from(list(SCORES)),
        "grasp": st.none() | st.integers(0, 999),
        "hidden": st.lists(NAMES),
        "reach_of": st.sampled_from(GRASP_KINDS),
        "reach_height_m": st.floats(0.0, HIGHEST_M),
    },
)


@given(CHANGES, CHANGES)
def test_only_what_is_given_changes(first: dict[str, object], second: dict[str, object]) -> None:
    view = SharedView().changed(checked(SharedView, **first)).changed(checked(SharedView, **second))
    assert view == checked(SharedView, **{**first, **second})
    assert view.changed(SharedView()) == view


@given(st.lists(st.tuples(NAMES, st.booleans())))
def test_a_layer_is_hidden_when_it_was_last_told_to_be(told: list[tuple[LayerName, bool]]) -> None:
    view = SharedView(hidden=())
    for name, shown in told:
        view = view.with_layer(name, shown)
    last: dict[str, bool] = dict(told)
    assert list(view.hidden) == [name for name in TITLES if not last.get(name, True)]


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"hidden": ["Rabbit"]}, "hidden.0: input should be 'Conveyor', 'Robot', 'Object'"),
        ({"grasps_by": "Beauty"}, "grasps_by: input should be 'Rank', 'Reachability', 'Quality in motion' or"),
        ({"grasp": -2}, "grasp: input should be greater than or equal to 0 (got -2)"),
        ({"auto_next": "yes"}, "auto_next: input should be a valid boolean (got 'yes')"),
        ({"camera": "top"}, "camera: extra inputs are not permitted (got 'top')"),
    ],
)
def test_what_cannot_be_shown_is_refused_with_what_can(given: dict[str, object], complaint: str) -> None:
    with pytest.raises(InvalidInputError) as refusal:
        checked(SharedView, **given)
    assert complaint in str(refusal.value)


def test_changes_from_many_threads_are_all_made() -> None:
    session = Session(FakeEngine(), LINEAR)
    start = threading.Barrier(len(TITLES))

    def slowly_hide(view: SharedView, name: str) -> SharedView:
        time.sleep(0.002)
        return view.with_layer(name, shown=False)

    def hide(name: str) -> None:
        start.wait()
        session.change_view(lambda view: slowly_hide(view, name))

    threads = [threading.Thread(target=hide, args=(name,)) for name in TITLES]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert list(session.state.view.hidden) == TITLES


def test_a_restart_keeps_the_view(session: Session) -> None:
    view = session.change_view(lambda view: view.changed(SharedView(grasp=3, hidden=("Plans",))))
    session.send(Restart(scenario="ur5_linear_slab", overrides={}))
    assert session.state.view == view


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


@pytest.fixture
def script(served: Served) -> Iterator[httpx.Client]:
    """Drives, from a trial at its start with everything shown."""
    begin_anew(served)
    with httpx.Client(base_url=served.address + "api/v1/session/", timeout=5.0) as client:
        client.post("driver")
        assert client.patch("view", json=PLAIN).json() == PLAIN
        yield client
        client.delete("driver")


def wait_until(script: httpx.Client, path: str, **fields: object) -> None:
    deadline = time.monotonic() + 20.0
    while not fields.items() <= (now := script.get(path).json()).items():
        assert time.monotonic() < deadline, f"{fields} not reached: {now}"
        time.sleep(0.03)


def heard(viewer: ViewerClient, uuid: str, value: object) -> None:
    viewer.wait_for("GuiUpdateMessage", uuid=uuid, updates={"value": value})


def test_the_answer_to_a_change_is_the_new_view_and_what_was_not_given_stays(script: httpx.Client) -> None:
    assert script.get("view").json() == PLAIN
    changed = script.patch("view", json={"grasp": 7, "hidden": ["Plans", "Robot", "Plans"]})
    assert changed.status_code == 200
    assert changed.json() == {**PLAIN, "grasp": 7, "hidden": ["Robot", "Plans"]}
    assert script.patch("view", json={}).json() == changed.json() == script.get("view").json()
    assert script.patch("view", json={"grasp": None}).json() == {**PLAIN, "hidden": ["Robot", "Plans"]}


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"hidden": ["Rabbit"]}, ("body.hidden.0:", *TITLES)),
        ({"grasps_by": "Beauty"}, ("body.grasps_by:", *SCORES)),
        ({"grasp": 1000}, ("body.grasp:", "less than or equal to 999")),
        ({"grasps_by": None}, ("body.grasps_by:", *SCORES)),
        ({"theme": "dark"}, ("body.theme:", "not permitted")),
    ],
)
def test_a_change_that_cannot_be_made_says_what_can(
    script: httpx.Client, given: dict[str, object], named: tuple[str, ...]
) -> None:
    refused = script.patch("view", json={"auto_next": True, **given})
    assert refused.status_code == 422
    assert all(name in refused.json()["error"] for name in named), refused.json()
    assert script.get("view").json() == PLAIN


def test_the_description_has_every_example_and_no_default_for_what_is_not_given(
    script: httpx.Client, served: Served
) -> None:
    description = httpx.get(served.address + "api/openapi.json").json()
    operation = description["paths"]["/api/v1/session/view"]["patch"]
    body = operation["requestBody"]["content"]["application/json"]
    assert set(body["examples"]) == set(VIEWS)
    given = description["components"]["schemas"][body["schema"]["$ref"].split("/")[-1]]
    assert "required" not in given and not any("default" in field for field in given["properties"].values())
    for example in VIEWS.values():
        assert script.patch("view", json=example.get("value")).status_code == 200


def test_who_does_not_drive_sees_the_view_and_cannot_change_it(script: httpx.Client, served: Served) -> None:
    script.delete("driver")
    with view(served.authority):
        wait_until(script, "driver", visitors=1)
        refused = script.patch("view", json={"auto_next": True})
        assert refused.status_code == 409 and "drives and you watch" in refused.json()["error"]
        assert script.get("view").json() == PLAIN


def test_what_a_script_changes_is_shown_on_every_page(script: httpx.Client, served: Served) -> None:
    play_to(served, 60)
    script.post("driver")
    with view(served.authority) as one, view(served.authority) as other:
        pages = (one, other)
        boxes = {label: one.widget("GuiCheckboxMessage", label) for label in ("Auto next", "Plans", "Robot")}
        score, number = one.widget("GuiDropdownMessage", "Colour by"), one.widget("GuiNumberMessage", "Grasp no.")
        script.patch(
            "view",
            json={"auto_next": True, "grasps_by": "Lift success", "grasp": 12, "hidden": ["Plans", "Robot"]},
        )
        for page in pages:
            heard(page, boxes["Auto next"], True)
            heard(page, boxes["Plans"], False)
            heard(page, boxes["Robot"], False)
            heard(page, score, "Lift success")
            heard(page, number, 12)
            for name in ("/plans", "/robot"):
                page.wait_for("SetSceneNodeVisibilityMessage", name=name, visible=False)
        script.patch("view", json={"hidden": ["Plans"], "grasp": None})
        for page in pages:
            heard(page, boxes["Robot"], True)
            heard(page, number, -1)
            page.wait_for("SetSceneNodeVisibilityMessage", name="/robot", visible=True)


def test_what_is_clicked_on_a_page_is_in_the_answer(script: httpx.Client, served: Served) -> None:
    with view(served.authority) as page:
        number = page.widget("GuiNumberMessage", "Grasp no.")
        script.patch("view", json={"grasp": 9})
        heard(page, number, 9)  # and with it what else has changed since the page before
        wait_until(script, "driver", visitors=1)
        script.delete("driver")
        page.set(page.widget("GuiCheckboxMessage", "Auto next"), True)
        page.set(page.widget("GuiCheckboxMessage", "Hand trail"), False)
        page.set(page.widget("GuiCheckboxMessage", "Conveyor"), False)
        page.set(page.widget("GuiDropdownMessage", "Colour by"), "Reachability")
        page.set(number, 4)
        wait_until(script, "view", auto_next=True, grasps_by="Reachability", grasp=4, hidden=["Conveyor", "Hand trail"])
        page.set(page.widget("GuiDropdownMessage", "Reach of"), "From the side")
        page.set(page.widget("GuiSliderMessage", "Height cm"), 25)
        wait_until(script, "view", reach_of="From the side", reach_height_m=0.25)
        page.set(number, -3)
        page.notice_saying("grasp: input should be greater than or equal to 0 (got -3)")
        heard(page, number, 4)
        page.set(number, -1)
        wait_until(script, "view", grasp=None)


def test_auto_next_that_cannot_go_on_turns_itself_off_and_says_so(script: httpx.Client, served: Served) -> None:
    script.post("commands", json={"kind": "restart", "scenario": "ur5_linear", "seed": LAST_SEED})
    wait_for(served, seed=LAST_SEED, loading=False)
    with view(served.authority) as page:
        box = page.widget("GuiCheckboxMessage", "Auto next")
        script.patch("view", json={"auto_next": True})
        heard(page, box, True)
        page.messages.clear()
        script.post("commands", json={"kind": "set_speed", "speed": None})
        script.post("commands", json={"kind": "set_paused", "paused": False})
        page.notice_saying(f"less than or equal to {LAST_SEED} (got {LAST_SEED + 1})\nAuto next is off now.")
        heard(page, box, False)
    wait_until(script, "view", auto_next=False)
    assert served.state()["seed"] == LAST_SEED
    script.post("commands", json={"kind": "set_speed", "speed": 1.0})
