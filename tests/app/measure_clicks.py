"""Measure how soon the page answers a click or a key: ``python -m tests.app.measure_clicks [--times 20] [--json]``.

Starts the real server, opens it in headless Chromium with every frame drawn, and prints for each deed the time from
the event in the browser to the first frame that shows its effect: median and most.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import cycle

from playwright.sync_api import Page, TimeoutError

from tests.app.browser import button, click_scene, open_browser, open_page, tab, wait_for_node
from tests.app.served import Served, begin_anew, serve

PAUSED_S = 0.3
RUNNING_S = 1.0
WATCH = """shown => {
    window.__tookMs = null;
    const isShown = eval(shown), before = isShown.before?.();
    let begin = null;
    const note = () => { begin ??= performance.now(); };
    for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, note, { capture: true });
    const look = () => {
        if (begin !== null && isShown.after(before)) window.__tookMs = performance.now() - begin;
        else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
}"""
"""Notes the first press from now on, then looks at every frame whether its effect is there."""
OBJECT_MOVES = """({
    before: () => window.__viserMutable.nodeRefFromName["/object/body"].position.y,
    after: y => window.__viserMutable.nodeRefFromName["/object/body"].position.y !== y,
})"""
LAYER_SWITCHES = """({
    before: () => window.__viserMutable.nodeRefFromName["/conveyor"].visible,
    after: was => window.__viserMutable.nodeRefFromName["/conveyor"].visible !== was,
})"""
BUTTON = """({ after: () => [...document.querySelectorAll("button")].some(b => b.textContent.trim() === "%s") })"""
SAID = """({
    before: () => document.body.textContent.split("%s").length,
    after: was => document.body.textContent.split("%s").length > was,
})"""
BELT = {"Stop": "Belt stopped", "Back": "Belt runs back", "Forth": "Belt runs forth"}
"""Buttons, and what is said when one has acted."""


@dataclass(frozen=True)
class Deed:
    """Something to press; what shows that it was heard is a script with ``before`` and ``after``."""

    name: str
    limit_s: float
    press: Callable[[Page], None]
    shown: str


def took_s(page: Page, deed: Deed) -> float:
    """From the press to the frame that shows its effect."""
    page.evaluate(WATCH, deed.shown)
    deed.press(page)
    try:
        page.wait_for_function("() => window.__tookMs !== null", timeout=20_000)
    except TimeoutError as error:
        raise AssertionError(f"{deed.name}: no effect within 20 s") from error
    return 1e-3 * float(str(page.evaluate("window.__tookMs")))


def key(name: str) -> Callable[[Page], None]:
    return lambda page: page.keyboard.press(name)


def measure(served: Served, page: Page, times: int) -> dict[str, tuple[float, list[float]]]:
    """Limit and seconds of each deed."""
    found = dict[str, tuple[float, list[float]]]()

    def see(deed: Deed) -> None:
        found.setdefault(deed.name, (deed.limit_s, []))[1].append(took_s(page, deed))

    click_scene(page, 640, 500)
    for _ in range(times):
        see(Deed("paused: step, key", PAUSED_S, key("ArrowRight"), OBJECT_MOVES))
        see(Deed("paused: step, button", PAUSED_S, lambda page: button(page, "Step").click(), OBJECT_MOVES))
    tab(page, "View")
    page.get_by_text("Show", exact=True).click()
    layer = page.get_by_role("checkbox", name="Conveyor")
    for _ in range(times):
        see(Deed("paused: layer", PAUSED_S, lambda page: layer.click(), LAYER_SWITCHES))
    tab(page, "Scenario")
    for running in (False, True):
        name, limit_s = ("running", RUNNING_S) if running else ("paused", PAUSED_S)
        for (label, said), _ in zip(cycle(BELT.items()), range(times), strict=False):
            begin_anew(served)
            served.command(kind="set_paused", paused=not running)
            page.wait_for_timeout(1000)
            click = button(page, label).click
            see(Deed(f"{name}: belt's direction", limit_s, lambda _, click=click: click(), SAID % (said, said)))
    for _ in range(times):
        begin_anew(served)
        page.wait_for_timeout(1000)
        see(Deed("paused: play", PAUSED_S, lambda page: button(page, "Play").click(), OBJECT_MOVES))
        page.wait_for_timeout(200)
        see(Deed("running: pause", RUNNING_S, lambda page: button(page, "Pause").click(), BUTTON % "Play"))
    return found


def main() -> int:
    """Exit code 1 when a median misses its limit."""
    parser = argparse.ArgumentParser(prog="python -m tests.app.measure_clicks", description=__doc__)
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--json", action="store_true", help="one JSON object instead of a table")
    options = parser.parse_args()
    flags = ("--paused", "--no-auto-next", "--no-tour", "--scenario", "ur5_linear")
    with serve(*flags, module=("run_server.py",)) as served, open_browser() as browser:
        while served.state()["tick"] is None:
            time.sleep(0.2)
        with open_page(browser, served.address, drawn=True) as page:
            wait_for_node(page, "/object/body", 60.0)
            page.wait_for_timeout(3000)
            found = measure(served, page, options.times)
    rows = {
        name: {"limit_s": limit_s, "median_s": statistics.median(seconds), "most_s": max(seconds)}
        for name, (limit_s, seconds) in found.items()
    }
    if options.json:
        print(json.dumps(rows))
    else:
        for name, row in rows.items():
            mark = "ok" if row["median_s"] <= row["limit_s"] else "MISSED"
            print(
                f"{name:24} median {row['median_s']:.2f} s, most {row['most_s']:.2f} s (limit {row['limit_s']}) {mark}"
            )
    return 0 if all(row["median_s"] <= row["limit_s"] for row in rows.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
