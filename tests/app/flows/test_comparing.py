"""Laws of comparing and of what is plotted, as people see them: headless Chromium over the fake engine."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.app.browser import button, choose, look_back, node_position, open_page, tab, wait_for_node
from tests.app.served import Served, begin_anew, play_to, wait_for

GONE = "name => !(name in window.__viserMutable.nodeRefFromName) || !window.__viserMutable.nodeRefFromName[name]"


@pytest.fixture(autouse=True)
def fresh_trial(served: Served) -> None:
    begin_anew(served)


def test_two_methods_are_compared_and_their_outcomes_appear(served: Served, page: Page) -> None:
    tab(page, "Method")
    choose(page, "Compare with", "baseline")
    expect(page.get_by_text("Restarted with baseline beside it.").first).to_be_visible()
    wait_for_node(page, "/beside/object/body")
    start = node_position(page, "/beside/object/body")
    assert start is not None and start == node_position(page, "/object/body")
    served.command(kind="apply_event", event={"kind": "set_belt_rate", "rate": 2.0})
    button(page, "Play").click()
    for name in ("/object/body", "/beside/object/body"):
        page.wait_for_function(
            "([name, y]) => window.__viserMutable.nodeRefFromName[name].position.y > y + 0.02", arg=[name, start[1]]
        )
    served.command(kind="set_speed", speed=None)
    state = wait_for(served, lambda s: s["outcome"] is not None)
    assert isinstance(state["compared"], dict)
    assert (state["tick"], state["compared"]["tick"]) == (600, 300)
    expect(page.get_by_text("ours_rm: lifted after 17.5 s").first).to_be_visible()
    expect(page.get_by_text("baseline: belt end").first).to_be_visible()
    expect(page.get_by_text("1 / 0 of 1")).to_be_visible()
    served.command(kind="set_speed", speed=1.0)
    served.command(kind="set_paused", paused=True)
    choose(page, "Compare with", "nothing")
    wait_for(served, lambda s: s["compared"] is None and s["tick"] == 0)
    page.wait_for_function(GONE, arg="/beside/object/body")


def test_both_are_looked_back_at_and_a_link_opens_both(served: Served, browser: Browser, page: Page) -> None:
    served.command(kind="restart", scenario="ur5_linear", seed=2, compare="baseline")
    wait_for(served, lambda s: s["seed"] == 2 and s["compared"] is not None and not s["loading"])
    served.command(kind="set_speed", speed=4.0)
    served.command(kind="set_paused", paused=False)
    wait_for(served, lambda s: int(str(s["tick"])) >= 150)
    served.command(kind="set_paused", paused=True)
    newest = wait_for(served, lambda s: s["paused"] is True)
    look_back(page, float(str(newest["t_s"])), 1.0)
    wait_for(served, lambda s: s["looked_at_s"] == pytest.approx(1.0, abs=0.4))  # a busy machine keeps fewer moments
    for name in ("/object/body", "/beside/object/body"):
        page.wait_for_function(
            "([name, y]) => window.__viserMutable.nodeRefFromName[name].position.y < y - 0.05",
            arg=[name, newest["object_m"][1]],  # pyright: ignore[reportIndexIssue, reportUnknownArgumentType]
        )
    tab(page, "Share")
    link = page.get_by_role("link", name="Copy link")
    expect(link).to_have_attribute("href", "/open?scenario=ur5_linear&seed=2&compare=baseline")
    served.command(kind="restart", scenario="mico_varying", seed=9)
    wait_for(served, lambda s: s["seed"] == 9 and s["compared"] is None and not s["loading"])
    with open_page(browser, served.address.rstrip("/") + str(link.get_attribute("href"))) as other:
        button(other, "Take control and open it").click()
        wait_for_node(other, "/beside/object/body")
        wait_for(served, lambda s: s["seed"] == 2 and s["compared"] is not None)
    served.command(kind="set_speed", speed=1.0)


def test_a_row_of_the_shortlist_shows_the_card_by_mouse_and_by_key(served: Served, page: Page) -> None:
    play_to(served, 60)
    served.command(kind="set_speed", speed=1.0)
    tab(page, "Grasps")
    rows = page.locator("[data-grasp]")
    expect(rows).to_have_count(10)
    numbers = [row.get_attribute("data-grasp") for row in rows.all()]
    rows.nth(2).click()
    expect(page.get_by_text(f"Grasp {numbers[2]}", exact=True)).to_be_visible()
    expect(page.get_by_label("Grasp no.")).to_have_value(f"{numbers[2]}")
    rows.nth(5).focus()
    page.keyboard.press("Enter")
    expect(page.get_by_text(f"Grasp {numbers[5]}", exact=True)).to_be_visible()
    expect(page.get_by_text(f"Grasp {numbers[2]}", exact=True)).to_be_hidden()
    tab(page, "Trial")


def test_plots_go_along_when_somebody_looks_back_and_lead_there(served: Served, page: Page) -> None:
    play_to(served, 240)
    served.command(kind="set_speed", speed=1.0)
    tab(page, "Signals")
    plots = page.locator("[data-strip]:visible")
    expect(page.get_by_text("Prediction error, when")).to_be_visible()
    expect(plots).to_have_count(6)
    figures = page.get_by_text("Hand to", exact=True).locator("xpath=../..")
    newest = figures.inner_text()
    box = plots.first.bounding_box()
    assert box is not None and box["x"] < 270, "the first is a plot on the left"
    page.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 20)
    page.mouse.down()
    for share in (0.15, 0.25, 0.4):
        wait_for(served, lambda s: s["looked_at_s"] is not None)
        page.wait_for_timeout(300)
        page.mouse.move(box["x"] + share * box["width"], box["y"] + 20)
    page.mouse.up()
    wait_for(served, lambda s: s["looked_at_s"] == pytest.approx(6.0, abs=0.4))
    expect(figures).not_to_have_text(newest)
    expect(page.get_by_text("New plan against the one before")).to_be_hidden()
    tab(page, "Trial")
    expect(page.get_by_text("The new plan departs from the one before: at most")).to_be_visible()
    served.command(kind="look_back", t_s=None)
