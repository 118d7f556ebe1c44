"""Laws of the experiments page as people use it, in headless Chromium."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from backend.experiments.grid.cells import make_plan
from backend.experiments.grid.settings import GridSettings
from backend.experiments.grid.work import run_job
from tests.app.browser import button, open_page, tab, wait_for_node
from tests.app.served import Served, serve, wait_for
from tests.experiments.grid.making import all_jobs, plan, row_of, store_in

OF = plan(trials=4)
KEPT = ("UR5 with Robotiq 2F-85", "IK-filtered grasps", "Linear", "cube")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("runs")
    with store_in(root / "done", OF) as store:
        for job in all_jobs(OF):
            store.add(row_of(job))
    (root / "broken").mkdir()
    (root / "broken" / "grid.sqlite").write_bytes(b"no database" * 1000)
    (root / "notes").mkdir()
    return root


@pytest.fixture(scope="module")
def served(folder: Path) -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour", "--runs", str(folder)) as server:
        yield server


@pytest.fixture
def page(served: Served, browser: Browser) -> Iterator[Page]:
    with open_page(browser, served.address + "experiments") as page:
        complaints: list[str] = []
        page.on("pageerror", lambda error: complaints.append(str(error)))
        expect(page.get_by_role("heading", name="done")).to_be_visible()
        yield page
        assert complaints == []


def test_a_running_grid_is_seen_to_come_along(browser: Browser, served: Served, folder: Path) -> None:
    jobs = iter(all_jobs(OF))
    with store_in(folder / "live", OF) as store, open_page(browser, served.address + "experiments#run=live") as page:
        expect(page.get_by_text("Started outside this page")).to_be_visible()
        expect(page.get_by_text("0 / 8")).to_be_visible()
        for _ in range(3):
            store.add(row_of(next(jobs)))
        expect(page.get_by_text("3 / 8")).to_be_visible()
        expect(page.locator(".methods")).to_contain_text("of 2")
    with open_page(browser, served.address + "experiments#run=live") as page:
        expect(button(page, "Go on")).to_be_visible()


def test_a_cell_leads_to_its_failed_trials_and_back(page: Page) -> None:
    page.locator(".cells button").first.click()
    expect(page.locator("tr.trial")).to_have_count(2)
    expect(page.get_by_label("outcome")).to_have_value("failure")
    expect(page.get_by_label("method")).to_have_value("ik")
    button(page, "Show all").click()
    expect(page.locator("tr.trial")).to_have_count(8)
    page.get_by_label("method").select_option("baseline")
    expect(page.locator("tr.trial")).to_have_count(4)
    page.go_back()
    expect(page.locator("tr.trial")).to_have_count(8)


def test_the_report_has_its_tables_and_plots(page: Page) -> None:
    tab(page, "Report")
    expect(page.locator(".plot .main-svg").first).to_be_visible(timeout=60_000)
    expect(page.get_by_text("8 of 8 trials")).to_be_visible()
    expect(page.locator(".plot")).to_have_count(7)


def test_what_is_broken_or_foreign_is_said_and_the_rest_goes_on(page: Page) -> None:
    page.locator(".run", has_text="broken").click()
    expect(page.get_by_text("This run cannot be read.")).to_be_visible()
    expect(page.locator(".note")).to_contain_text("--salvage")
    page.locator(".run", has_text="notes").click()
    expect(page.get_by_text("This is not a run.")).to_be_visible()
    page.locator(".run", has_text="done").click()
    expect(page.get_by_text("8 / 8")).to_be_visible()


def test_dark_is_chosen_and_remembered(page: Page) -> None:
    theme = page.locator("html")
    expect(theme).to_have_attribute("data-theme", "light")
    button(page, "Dark").click()
    expect(theme).to_have_attribute("data-theme", "dark")
    page.reload()
    expect(theme).to_have_attribute("data-theme", "dark")
    button(page, "Light").click()


def test_on_a_phone_nothing_is_wider_than_the_screen(page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    for name in ("Overview", "Trials", "Settings"):
        tab(page, name)
        page.wait_for_function("() => document.documentElement.scrollWidth <= innerWidth")


def test_a_server_that_goes_away_is_told(browser: Browser, tmp_path: Path) -> None:
    with (
        serve("--paused", "--runs", str(tmp_path)) as served,
        open_page(browser, served.address + "experiments") as page,
    ):
        expect(page.get_by_text("No runs yet")).to_be_visible()
        expect(page.get_by_text("python -m backend grid --out runs/first")).to_be_visible()
        served.process.kill()
        expect(page.get_by_text("The server does not answer")).to_be_visible()


def test_a_grid_is_begun_on_the_page_and_stopped(browser: Browser, tmp_path: Path) -> None:
    with (
        serve("--paused", "--runs", str(tmp_path)) as served,
        open_page(browser, served.address + "experiments") as page,
    ):
        page.locator("#new").click()
        expect(page.get_by_text("5880 trials: about")).to_be_visible()
        for box in page.locator(".checks label").all():
            box.locator("input").set_checked(box.inner_text().strip() in KEPT)
        expect(page.get_by_text("10 trials: about 1 min")).to_be_visible()
        page.get_by_label("Trials of each").fill("0")
        expect(page.get_by_text("greater than or equal to 1")).to_be_visible()
        expect(button(page, "Start")).to_be_disabled()
        page.get_by_label("Trials of each").fill("200")
        page.get_by_label("Name").fill("mine")
        expect(button(page, "Start")).to_be_enabled()
        button(page, "Start").click()
        expect(page.get_by_role("heading", name="mine")).to_be_visible()
        expect(page.get_by_role("heading", name="Success by method")).to_be_visible(timeout=90_000)
        button(page, "Stop").click()
        expect(button(page, "Go on")).to_be_visible(timeout=60_000)
        expect(page.locator(".head .badge")).to_have_text("stopped")


def test_a_failed_trial_is_opened_in_the_scene_and_comes_out_as_its_row_says(browser: Browser, tmp_path: Path) -> None:
    hasty = make_plan(
        GridSettings(
            robots=("ur5_robotiq",),
            tasks=("linear",),
            objects=("cube",),
            methods=("ik",),
            trials=2,
            first_seed=5,
            set=("timing.timeout_s=2.0",),
        )
    )
    with store_in(tmp_path / "hasty", hasty) as store:
        for job in all_jobs(hasty):
            store.add(run_job(job, store.facts.settings))
        assert {row.reason for row in store.rows()} == {"timeout"}
    flags = ("--no-auto-next", "--no-tour", "--runs", str(tmp_path))
    with serve(*flags, module=("run_server.py",)) as served, open_page(browser, served.address + "experiments") as page:
        page.locator(".cells button").click()
        with page.expect_popup() as opened:
            page.locator("tr.trial", has_text="timeout").nth(1).get_by_role("link", name="Replay").click()
        scene = opened.value
        wait_for_node(scene, "/object/body", 60.0)
        state = wait_for(served, lambda s: s["seed"] == 6 and not s["loading"] and s["outcome"] is not None, 60.0)
        assert (state["scenario"], state["object"], state["method"]) == ("ur5_linear", "cube", "ik")
        expect(scene.get_by_text("Not grasped", exact=True)).to_be_visible()
        expect(page.get_by_text("outcome and fingerprint are those of the row")).to_be_visible()
        scene.close()
