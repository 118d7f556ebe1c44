"""Pictures of the page with the real engine: ``python -m tests.app.screenshots`` writes ``docs/dashboard_*.png``."""

from __future__ import annotations

import io
import math
import time
from typing import cast

from PIL import Image
from playwright.sync_api import Browser, Page

from tests.app.browser import button, choose, close_notifications, open_browser, open_page, tab, wait_for_node
from tests.app.served import ROOT, Served, serve

PICTURES = (("dashboard_ur5", "ur5_linear_obstacles", "Trial"), ("dashboard_mico", "mico_linear_slab", "Grasps"))
SCORE = "Lift success"
NEAR_M = 0.4
PATIENCE_S = 300.0


def main() -> None:
    """One picture per arm, each at a moment when the hand is on its way to the object."""
    with open_browser() as browser:
        for name, scenario, left in PICTURES:
            flags = ("--scenario", scenario, "--paused", "--no-auto-next", "--no-tour")
            with serve(*flags, module=("run_server.py",)) as served:
                _take(browser, served, name, left)


def _take(browser: Browser, served: Served, name: str, left: str) -> None:
    with open_page(browser, served.address) as page:
        wait_for_node(page, "/object/body", 120.0)
        close_notifications(page)
        tab(page, left)
        if left == "Grasps":
            choose(page, "Colour by", SCORE)
        page.mouse.move(640, 60)  # no tooltip in the picture
        _play_to_a_good_moment(served, page)
        time.sleep(3.0)
        path = ROOT / "docs" / f"{name}.png"
        picture = Image.open(io.BytesIO(page.screenshot()))
        picture.convert("RGB").save(path, optimize=True)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB, seed {served.state()['seed']}")


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
