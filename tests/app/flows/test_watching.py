"""Laws of the page as people use it, in headless Chromium over the fake engine."""

from __future__ import annotations

import os
import signal
import time

import pytest
from playwright.sync_api import Page, expect

from tests.app.browser import (
    button,
    choose,
    click_scene,
    node_position,
    slider_box,
    tab,
    wait_for_node,
)
from tests.app.served import Served, wait_for


@pytest.fixture(autouse=True)
def fresh_trial(served: Served, page: Page) -> None:
    assert served.command(kind="set_paused", paused=True).status_code == 202
    assert served.command(kind="restart", scenario="ur5_linear", seed=0).status_code == 202
    wait_for(served, lambda s: s["tick"] == 0 and s["loading"] is False and s["paused"] is True)


def y_of_object(page: Page) -> float:
    position = node_position(page, "/object/body")
    assert position is not None
    return position[1]


def test_play_moves_the_scene_and_pause_holds_it(served: Served, page: Page) -> None:
    button(page, "Play").click()
    wait_for(served, lambda s: s["paused"] is False)
    start = y_of_object(page)
    page.wait_for_function(
        "start => window.__viserMutable.nodeRefFromName['/object/body'].position.y > start + 0.01", arg=start
    )
    button(page, "Pause").click()
    state = wait_for(served, lambda s: s["paused"] is True)
    expect(button(page, "Play")).to_be_visible()
    time.sleep(0.3)
    assert served.state()["tick"] == state["tick"]


def test_step_advances_one_tick_and_reset_begins_anew(served: Served, page: Page) -> None:
    button(page, "Step").click()
    wait_for(served, lambda s: s["tick"] == 1)
    button(page, "Step").click()
    wait_for(served, lambda s: s["tick"] == 2)
    run = served.state()["run"]
    button(page, "Reset").click()
    wait_for(served, lambda s: s["tick"] == 0 and s["run"] != run)
    expect(page.get_by_text("Trial restarted with seed 0.").first).to_be_visible()


def test_the_same_by_keys(served: Served, page: Page) -> None:
    click_scene(page, 200, 300)
    page.keyboard.press("ArrowRight")
    wait_for(served, lambda s: s["tick"] == 1)
    page.keyboard.press("n")
    wait_for(served, lambda s: s["seed"] == 1 and not s["loading"])
    page.keyboard.press("Space")
    wait_for(served, lambda s: s["paused"] is False)


def test_a_picked_scenario_restarts_and_says_so(served: Served, page: Page) -> None:
    choose(page, "Scenario", "mico_varying")
    wait_for(served, lambda s: s["robot"] == "mico" and not s["loading"])
    expect(page.get_by_text("Restarted with scenario mico_varying.").first).to_be_visible()
    wait_for_node(page, "/robot/m1n6s200_link_6")
    expect(page.get_by_text("Belt factor")).to_be_visible()


def test_a_belt_speed_acts_on_the_running_trial_and_says_so(served: Served, page: Page) -> None:
    run = served.state()["run"]
    slider_box(page, "Belt, cm/s").fill("-2.5")
    page.keyboard.press("Enter")
    expect(page.get_by_text("Belt set to -2.5 cm/s in the running trial.").first).to_be_visible()
    button(page, "Step").click()
    state = wait_for(served, lambda s: s["belt_rate"] == -0.5)
    assert state["run"] == run


def test_a_bad_value_is_refused_with_its_bound(served: Served, page: Page) -> None:
    page.get_by_label("Seed").fill("-5")
    expect(page.get_by_text("seed: input should be greater than or equal to 0 (got -5)").first).to_be_visible()
    expect(page.get_by_label("Seed")).to_have_value("0", timeout=10_000)
    assert served.state()["seed"] == 0


def test_a_layer_can_be_hidden(page: Page) -> None:
    tab(page, "View")
    page.get_by_text("Show", exact=True).click()
    page.get_by_role("checkbox", name="Conveyor").click()
    page.wait_for_function("() => window.__viserMutable.nodeRefFromName['/conveyor'].visible === false")
    tab(page, "Scenario")


def test_an_outcome_is_shown_and_the_next_seed_follows_when_asked(served: Served, page: Page) -> None:
    served.command(kind="set_speed", speed=None)
    served.command(kind="set_paused", paused=False)
    expect(page.get_by_text("Grasped", exact=True)).to_be_visible()
    expect(page.get_by_text("1 of 1 (100 %)")).to_be_visible()
    page.get_by_label("Auto next").check()
    expect(page.get_by_text("Next trial in")).to_be_visible()
    wait_for(served, lambda s: s["seed"] == 1)
    page.get_by_label("Auto next").uncheck()
    served.command(kind="set_speed", speed=1.0)


def test_a_killed_simulation_is_explained_and_started_again(served: Served, page: Page) -> None:
    os.kill(served.simulation_pid(), signal.SIGKILL)
    expect(page.get_by_text("The simulation has ended")).to_be_visible()
    expect(page.get_by_text("ended by SIGKILL").first).to_be_visible()
    button(page, "Restart simulation").last.click()
    wait_for(served, lambda s: s["simulation"] == "running" and s["tick"] is not None)
    expect(page.get_by_text("The simulation has ended")).to_be_hidden()
