"""One browser for all flows; a server and a page for each file."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.app.browser import open_browser, open_page, wait_for_node
from tests.app.served import Served, serve

PATIENCE_S = 180


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Flows share a browser, so one worker runs them all; pytest-xdist, whose turn is next, must see the mark."""
    for item in items:
        if item.path.parent.name == "flows":
            item.add_marker(pytest.mark.xdist_group("browser"))
            item.add_marker(pytest.mark.timeout(PATIENCE_S))


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """While it is open, its event loop counts as running in this thread: it has to go before other tests come."""
    expect.set_options(timeout=20_000)
    with open_browser() as browser:
        yield browser


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


@pytest.fixture(scope="module")
def page(served: Served, browser: Browser) -> Iterator[Page]:
    with open_page(browser, served.address) as page:
        wait_for_node(page, "/object/body", 30.0)
        yield page
