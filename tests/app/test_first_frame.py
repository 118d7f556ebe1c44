"""The law of the first frame, alone in its browser."""

import time

import pytest

from tests.app.browser import open_browser, open_page, wait_for_node
from tests.app.served import serve

pytestmark = [pytest.mark.timeout(90), pytest.mark.xdist_group("browser")]
FIRST_FRAME_S = 8.0
SETTLE_S = 20.0


def test_the_first_frame_is_there_in_time() -> None:
    with serve("--paused") as served, open_browser() as browser, open_page(browser, "about:blank") as page:
        deadline = time.monotonic() + SETTLE_S
        while served.state()["tick"] is None:
            assert time.monotonic() < deadline
            time.sleep(0.05)
        start = time.monotonic()
        page.goto(served.address)
        wait_for_node(page, "/object/body", FIRST_FRAME_S)
        wait_for_node(page, "/robot/wrist_3_link", FIRST_FRAME_S)
        assert time.monotonic() - start < FIRST_FRAME_S
