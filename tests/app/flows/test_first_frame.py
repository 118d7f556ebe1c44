"""The law of the first frame."""

import time

from playwright.sync_api import Browser

from tests.app.browser import open_page, wait_for_node
from tests.app.served import serve

FIRST_FRAME_S = 8.0
SETTLE_S = 20.0


def test_the_first_frame_is_there_in_time(browser: Browser) -> None:
    with serve("--paused") as served, open_page(browser, "about:blank", drawn=True) as page:
        deadline = time.monotonic() + SETTLE_S
        while served.state()["tick"] is None:
            assert time.monotonic() < deadline
            time.sleep(0.05)
        start = time.monotonic()
        page.goto(served.address)
        wait_for_node(page, "/object/body", FIRST_FRAME_S)
        wait_for_node(page, "/robot/wrist_3_link", FIRST_FRAME_S)
        assert time.monotonic() - start < FIRST_FRAME_S
