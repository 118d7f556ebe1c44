"""Pictures of the pages with the real engine: ``python -m tests.app.screenshots`` writes ``docs/dashboard_*.png`` and
``docs/experiments.png``; names as arguments take only those."""

from __future__ import annotations

import io
import math
import sys
import tempfile
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import cast

import httpx
from PIL import Image
from playwright.sync_api import Browser, Page

from tests.app.browser import button, choose, close_notifications, open_browser, open_page, tab, wait_for_node
from tests.app.served import ROOT, Served, serve, wait_for

PICTURES = (
    ("dashboard_ur5", "ur5_linear_obstacles", 0, "Trial"),
    ("dashboard_mico", "mico_linear_slab", 2, "Grasps"),
)
"""File, scenario, seed, and what is shown on the left."""
COMPARED = {"scenario": "ur5_linear", "seed": 7, "compare": "no_prediction"}
"""With a seed that one of the two fails with."""
SCORE = "Lift success"
NEAR_M = 0.4
PATIENCE_S = 300.0
GRID: dict[str, object] = {
    "name": "first_look",
    "objects": ["sugar_box"],
    "methods": ["ours_rm", "baseline", "no_prediction"],
    "trials": 3,
}
SHARE = 0.6
GRID_PATIENCE_S = 1200.0


def main() -> None:
    """Both arms, at a moment when the hand is on its way to the object; two methods compared; a running grid."""
    wanted = sys.argv[1:]
    with open_browser() as browser:
        for name, scenario, seed, left in PICTURES:
            if wanted and name not in wanted:
                continue
            with _page_of(browser, scenario) as (served, page):
                served.command(kind="restart", scenario=scenario, seed=seed)
                wait_for(served, lambda state: state["tick"] == 0 and state["loading"] is False)
                tab(page, left)
                if left == "Grasps":
                    choose(page, "Colour by", SCORE)
                _play_to_a_good_moment(served, page)
                _save_at_rest(page, name, served)
        if not wanted or "dashboard_compare" in wanted:
            _take_comparison(browser)
        if not wanted or "experiments" in wanted:
            with tempfile.TemporaryDirectory() as folder:
                _take_grid(browser, folder)


def _take_comparison(browser: Browser) -> None:
    """When both have ended."""
    with _page_of(browser, str(COMPARED["scenario"])) as (served, page):
        tab(page, "Method")
        served.command(kind="restart", **COMPARED)
        _play_until(served, lambda state: state["compared"] is not None and state["outcome"] is not None)
        _play_until(served, lambda state: cast("dict[str, object]", state["compared"])["outcome"] is not None)
        _save_at_rest(page, "dashboard_compare", served)


@contextmanager
def _page_of(browser: Browser, scenario: str) -> Generator[tuple[Served, Page]]:
    flags = ("--scenario", scenario, "--paused", "--no-auto-next", "--no-tour")
    with (
        serve(*flags, module=("run_server.py",)) as served,
        open_page(browser, served.address, drawn=True) as page,
    ):
        wait_for_node(page, "/object/body", 120.0)
        close_notifications(page)
        yield served, page


def _save_at_rest(page: Page, name: str, served: Served) -> None:
    time.sleep(3.0)
    close_notifications(page)
    page.mouse.move(640, 60)  # no tooltip in the picture
    time.sleep(1.0)
    _save(page, name)
    print(f"seed {served.state()['seed']}")


def _take_grid(browser: Browser, folder: str) -> None:
    """A grid that is begun here, when a good part of it is done."""
    runs = f"{folder}/runs"
    with serve("--paused", "--no-auto-next", "--runs", runs, module=("run_server.py",)) as served:
        address = served.address + "api/v1/runs"
        httpx.post(address, json=GRID, timeout=60.0).raise_for_status()
        deadline = time.monotonic() + GRID_PATIENCE_S
        while time.monotonic() < deadline:
            run = httpx.get(f"{address}/{GRID['name']}", timeout=60.0).json()
            if run["trials"] and run["done"] >= SHARE * run["trials"]:
                break
            time.sleep(1.0)
        with open_page(browser, served.address + "experiments", drawn=True) as page:
            page.locator(".cells").first.wait_for()
            _save(page, "experiments")


def _save(page: Page, name: str) -> None:
    path = ROOT / "docs" / f"{name}.png"
    picture = Image.open(io.BytesIO(page.screenshot()))
    picture.convert("RGB").save(path, optimize=True)
    print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")


def _play_until(served: Served, ready: Callable[[dict[str, object]], bool]) -> None:
    served.command(kind="set_paused", paused=False)
    deadline = time.monotonic() + PATIENCE_S
    while not ready(served.state()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"Not reached within {PATIENCE_S:g} s: {served.state()}")
        time.sleep(0.1)
    served.command(kind="set_paused", paused=True)


def _play_to_a_good_moment(served: Served, page: Page) -> None:
    """Play, from seed to seed, until the hand is near the object and has not begun the approach."""
    served.command(kind="set_paused", paused=False)
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        state = served.state()
        if state["outcome"] is not None:
            button(page, "Next seed").click()
            time.sleep(1.0)
        elif state["phase"] == "move" and _distance_m(state) < NEAR_M:
            served.command(kind="set_paused", paused=True)
            return
        time.sleep(0.03)
    raise TimeoutError(f"The hand came nowhere near the object within {PATIENCE_S:g} s.")


def _distance_m(state: dict[str, object]) -> float:
    hand_m, object_m = cast("list[float]", state["hand_m"]), cast("list[float]", state["object_m"])
    return math.dist(hand_m, object_m)


if __name__ == "__main__":
    main()
