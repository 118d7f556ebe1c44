"""A headless Chromium on the dashboard; the only file that knows viser's own test hooks."""

from __future__ import annotations

import shutil
from collections.abc import Generator
from contextlib import contextmanager
from typing import cast

from playwright.sync_api import Browser, Locator, Page, sync_playwright

FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
NAMES = ("chromium", "chromium-browser", "google-chrome")
NO_DRAWING = """for (const context of [WebGLRenderingContext, WebGL2RenderingContext])
    for (const draw of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced", "clear"])
        context.prototype[draw] = () => {};"""
"""Without a graphics card, drawing the scene takes a whole core from what is tested; all else goes on as ever."""
POSITION = "name => window.__viserMutable?.nodeRefFromName?.[name]?.position?.toArray() ?? null"
"""Where a scene node stands in its parent; null while it is not there."""


@contextmanager
def open_browser() -> Generator[Browser]:
    """A headless Chromium, closed at the end."""
    executable = next((path for path in map(shutil.which, NAMES) if path), None)
    assert executable, f"None of {', '.join(NAMES)} is on the PATH: `make test` installs one."
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, headless=True, args=list(FLAGS))
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def open_page(
    browser: Browser, address: str, width: int = 1280, height: int = 720, *, drawn: bool = False
) -> Generator[Page]:
    """A page on ``address``, closed at the end; the 3-D scene is drawn only where its picture is wanted."""
    page = browser.new_page(viewport={"width": width, "height": height})
    page.set_default_timeout(15_000)
    if not drawn:
        page.add_init_script(NO_DRAWING)
    try:
        page.goto(address)
        yield page
    finally:
        page.close()


def node_position(page: Page, name: str) -> list[float] | None:
    """Position of a 3-D node in its parent's frame; None while it is not there."""
    return cast("list[float] | None", page.evaluate(POSITION, name))


def wait_for_node(page: Page, name: str, timeout_s: float = 15.0) -> None:
    """Until a 3-D node is in the scene."""
    page.wait_for_function(f"name => ({POSITION})(name) !== null", arg=name, timeout=1e3 * timeout_s)


def click_scene(page: Page, x: float, y: float) -> None:
    """Click into the 3-D view, so that keys go there."""
    page.locator("canvas[data-engine]").click(position={"x": x, "y": y})


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name, exact=True)


def choose(page: Page, label: str, option: str) -> None:
    """Pick an option of a drop-down."""
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=True).click()


def slider_box(page: Page, label: str) -> Locator:
    """The number box beside a slider."""
    uuid = page.locator("label", has_text=label).first.get_attribute("for")
    return page.locator(f'xpath=//*[@id="{uuid}"]/ancestor::*[.//input[@type="text"]][1]//input[@type="text"]')


def look_back(page: Page, newest_s: float, to_s: float) -> None:
    """Type a time into the timeline, once that has come to rest at the newest moment of a paused trial."""
    box = slider_box(page, "Time, s")
    for _ in range(200):
        if abs(float(box.input_value() or "nan") - newest_s) < 0.15:
            break
        page.wait_for_timeout(50)
    box.fill(f"{to_s:g}")
    page.keyboard.press("Enter")


def close_notifications(page: Page) -> None:
    """Close what viser itself has to say, such as that it draws without a graphics card."""
    for notification in page.locator(".mantine-Notification-closeButton").all():
        notification.click()


def on_screen(page: Page, name: str) -> tuple[float, float]:
    """Where the middle of a 3-D node is on the page, in pixels."""
    script = """name => {
        const node = window.__viserMutable.nodeRefFromName[name], camera = window.__viserMutable.camera;
        const at = node.getWorldPosition(node.position.clone());
        at.project(camera);
        const box = document.querySelector("canvas[data-engine]").getBoundingClientRect();
        return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
    }"""
    x, y = cast("list[float]", page.evaluate(script, name))
    return x, y


def tab(page: Page, name: str) -> None:
    """Open a tab."""
    page.get_by_role("tab", name=name, exact=True).click()


def is_dark(page: Page) -> bool:
    return page.evaluate("document.documentElement.getAttribute('data-mantine-color-scheme')") == "dark"
