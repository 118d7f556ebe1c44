"""Laws of what a researcher does on the page, in headless Chromium over the fake engine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urljoin

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.app.browser import (
    button,
    choose,
    click_scene,
    is_dark,
    look_back,
    node_position,
    on_screen,
    open_page,
    tab,
    wait_for_node,
)
from tests.app.served import Served, begin_anew, play_to, serve, wait_for


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next") as server:
        yield server


@pytest.fixture(scope="module")
def page(served: Served, browser: Browser) -> Iterator[Page]:
    with open_page(browser, served.address) as page:
        wait_for_node(page, "/object/body", 30.0)
        button(page, "Skip the tour").click()
        yield page


@pytest.fixture(autouse=True)
def fresh_trial(served: Served) -> None:
    begin_anew(served)


STRIP_BOX = "() => document.querySelector('[data-strip]')?.getBoundingClientRect().toJSON()"
"""In one look, for the strip is drawn anew while the trial goes on."""


def test_whoever_comes_first_is_shown_around_and_only_once(served: Served, browser: Browser) -> None:
    with open_page(browser, served.address) as stranger:
        expect(stranger.get_by_text("A robot grasps what moves (1 of 5)")).to_be_visible()
        for number in (2, 3, 4, 5):
            button(stranger, "Next").click()
            expect(stranger.get_by_text(f"({number} of 5)")).to_be_visible()
        button(stranger, "Start").click()
        expect(stranger.get_by_text("(5 of 5)")).to_be_hidden()
        stranger.reload()
        wait_for_node(stranger, "/object/body")
        stranger.wait_for_timeout(1500)
        expect(stranger.get_by_text("(1 of 5)")).to_be_hidden()


def test_a_part_of_the_method_is_switched_alone_and_its_own_settings_come(served: Served, page: Page) -> None:
    tab(page, "Method")
    choose(page, "Predictor", "constant_velocity")
    wait_for(served, lambda s: s["overrides"] == {"method.predictor.kind": "constant_velocity"} and not s["loading"])
    expect(page.get_by_text("Predictor", exact=True)).to_have_count(2)
    page.get_by_text("Predictor", exact=True).last.click()
    expect(page.get_by_label("Window, s")).to_have_value("0.5")
    page.get_by_label("Window, s").fill("99")
    expect(page.get_by_text("window_s: input should be less than or equal to 10 (got 99.0)").first).to_be_visible()
    expect(page.get_by_label("Window, s")).to_have_value("0.5")
    page.get_by_role("checkbox", name="Seeded").click()
    wait_for(served, lambda s: "'method.planner.seeded': False" in str(s["overrides"]))
    tab(page, "Scenario")


def test_the_past_is_looked_at_and_gone_on_from(served: Served, page: Page) -> None:
    play_to(served, 150)
    before = served.state()
    look_back(page, float(str(before["t_s"])), 2.0)
    wait_for(served, lambda s: s["looked_at_s"] == pytest.approx(2.0, abs=0.15))
    expect(page.get_by_text("Looking back at")).to_be_visible()
    page.wait_for_function("() => window.__viserMutable.nodeRefFromName['/object/body'].position.y < -0.35")
    served.command(kind="set_speed", speed=0.125)
    button(page, "Go on from here").click()
    after = wait_for(served, lambda s: s["run"] != before["run"] and s["tick"] is not None and s["paused"] is False)
    assert 55 <= int(str(after["tick"])) < 90 and after["looked_at_s"] is None
    served.command(kind="set_speed", speed=1.0)


def test_a_click_on_the_timeline_looks_back(served: Served, page: Page) -> None:
    play_to(served, 300)
    expect(page.locator("[data-strip]")).to_be_visible()
    page.wait_for_timeout(1500)
    box = page.wait_for_function(STRIP_BOX).json_value()
    page.mouse.click(box["x"] + 0.1 * box["width"], box["y"] + 6)
    state = wait_for(served, lambda s: s["looked_at_s"] is not None)
    assert state["looked_at_s"] == pytest.approx(1.5, abs=0.3)
    button(page, "Back to newest").click()
    wait_for(served, lambda s: s["looked_at_s"] is None)


def test_the_arrows_step_and_leave_the_camera_alone(served: Served, page: Page) -> None:
    click_scene(page, 100, 200)
    camera = page.evaluate("window.__viserMutable.camera.position.toArray()")
    for expected in (1, 2):
        page.keyboard.press("ArrowRight")
        wait_for(served, lambda s, tick=expected: s["tick"] == tick)
    page.keyboard.press("ArrowLeft")
    wait_for(served, lambda s: s["looked_at_s"] is not None)
    assert page.evaluate("window.__viserMutable.camera.position.toArray()") == pytest.approx(camera, abs=1e-6)


def test_a_copied_link_opens_the_same_trial_in_another_browser(served: Served, browser: Browser, page: Page) -> None:
    served.command(kind="restart", scenario="ur5_linear_slab", seed=3, overrides={"object": "sugar_box"})
    wait_for(served, lambda s: s["seed"] == 3 and s["tick"] == 0 and not s["loading"])
    served.command(kind="apply_event", event={"kind": "set_belt_rate", "rate": 2.0})
    wait_for(served, lambda s: s["live_edits"] == 1)
    tab(page, "Share")
    link = page.get_by_role("link", name="Copy link")
    expect(link).to_have_attribute(
        "href",
        "/open?scenario=ur5_linear_slab&seed=3&set=%7B%22object%22%3A%22sugar_box%22%7D"
        "&edits=%5B%7B%22tick%22%3A0%2C%22event%22%3A%7B%22kind%22%3A%22set_belt_rate%22%2C%22rate%22%3A2.0%7D%7D%5D",
    )
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    link.click()
    expect(page.get_by_role("link", name="Copied")).to_be_visible()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert copied == urljoin(served.address, str(link.get_attribute("href")))
    served.command(kind="restart", scenario="mico_varying", seed=9)
    wait_for(served, lambda s: s["seed"] == 9 and not s["loading"])
    with open_page(browser, copied) as other:
        expect(other.get_by_text("this link would restart what everybody sees")).to_be_visible()
        assert served.state()["seed"] == 9
        button(other, "Take control and open it").click()
        wait_for_node(other, "/obstacles/slab")
        state = wait_for(served, lambda s: s["seed"] == 3 and not s["loading"])
    assert (state["scenario"], state["object"], state["live_edits"]) == ("ur5_linear_slab", "sugar_box", 1)
    tab(page, "Scenario")


def test_a_file_is_opened_and_a_bad_one_explained(served: Served, page: Page, tmp_path: Path) -> None:
    tab(page, "Share")
    with page.expect_download() as downloading:
        page.get_by_role("link", name="Download scenario").click()
    good = tmp_path / "mine.toml"
    downloading.value.save_as(good)
    bad = tmp_path / "bad.toml"
    bad.write_text(good.read_text().replace("speed_mps", "sped_mps"))
    for path in (bad, good):
        with page.expect_file_chooser() as choosing:
            button(page, "Open a file").click()
        choosing.value.set_files(path)
        if path is bad:
            expect(page.get_by_text("sped_mps: extra inputs are not permitted").first).to_be_visible()
            assert served.state()["scenario"] == "ur5_linear"
    wait_for(served, lambda s: s["scenario"] == "mine" and not s["loading"])
    tab(page, "Scenario")
    expect(page.get_by_role("combobox", name="Scenario")).to_have_value("mine")


def test_dark_is_of_one_browser_and_remembered(served: Served, browser: Browser, page: Page) -> None:
    tab(page, "View")
    button(page, "Dark").click()
    page.wait_for_function("() => document.documentElement.getAttribute('data-mantine-color-scheme') === 'dark'")
    with open_page(browser, served.address) as other:
        wait_for_node(other, "/object/body")
        assert not is_dark(other)
    page.reload()
    wait_for_node(page, "/object/body")
    page.wait_for_function("() => document.documentElement.getAttribute('data-mantine-color-scheme') === 'dark'")
    click_scene(page, 100, 200)
    page.keyboard.press("l")
    page.wait_for_function("() => document.documentElement.getAttribute('data-mantine-color-scheme') === 'light'")


def test_a_camera_preset_moves_the_camera(page: Page) -> None:
    tab(page, "View")
    look = "() => window.__viserMutable.camera.position.toArray()"
    before = page.evaluate(look)
    button(page, "Above").click()
    page.wait_for_function(f"was => Math.hypot(...({look})().map((x, i) => x - was[i])) > 0.5", arg=before)
    button(page, "Overview").click()
    tab(page, "Scenario")


def test_an_obstacle_is_dragged_while_the_trial_runs_and_the_edit_recorded(served: Served, page: Page) -> None:
    page.wait_for_timeout(1000)
    before = node_position(page, "/obstacles/1")
    x, y = on_screen(page, "/obstacles/1")
    page.mouse.move(x, y - 5)
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(x - 6 * k, y - 5 - 2 * k)
        page.wait_for_timeout(150)
    page.mouse.up()
    wait_for(served, lambda s: s["live_edits"] == 1)
    expect(page.get_by_text("Obstacle 2 moved to").first).to_be_visible()
    after = node_position(page, "/obstacles/1")
    assert before is not None and after is not None
    moved = sum((a - b) ** 2 for a, b in zip(after, before, strict=True)) ** 0.5
    assert 0.03 < moved < 0.6 and after[2] == pytest.approx(before[2])


def test_an_obstacle_is_put_up_and_a_slab_hung_while_the_trial_is_paused(served: Served, page: Page) -> None:
    tab(page, "Scenario")
    page.get_by_text("Obstacles (act at once)").first.click()
    button(page, "Add").click()
    expect(page.get_by_text("tomato_soup_can put up at").first).to_be_visible()
    wait_for_node(page, "/obstacles/3")
    page.get_by_label("Slab", exact=True).check()
    wait_for_node(page, "/obstacles/slab")
    button(page, "Remove").click()
    expect(page.get_by_text("taken away in the running trial").first).to_be_visible()
    wait_for(served, lambda s: s["live_edits"] == 3)
    page.get_by_text("Obstacles (act at once)").first.click()


def test_the_card_of_a_grasp_says_what_became_of_it(served: Served, page: Page) -> None:
    play_to(served, 60)
    tab(page, "Grasps")
    expect(page.get_by_text("From all grasps to one")).to_be_visible()
    page.get_by_label("Grasp no.").fill("29")
    expect(page.get_by_text("Grasp 29", exact=True)).to_be_visible()
    expect(page.get_by_text("Became")).to_be_visible()
    tab(page, "Trial")


def test_help_names_the_keys(page: Page) -> None:
    click_scene(page, 100, 200)
    page.keyboard.press("h")
    expect(page.get_by_text("the same trial again from its start")).to_be_visible()
    button(page, "Close").click()
    expect(page.get_by_text("the same trial again from its start")).to_be_hidden()
