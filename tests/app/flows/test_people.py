"""Laws of several browsers at one server, and of one whose server goes away, in headless Chromium."""

from __future__ import annotations

import signal

from playwright.sync_api import Browser, Page, expect

from tests.app.browser import button, choose, node_position, open_page, wait_for_node
from tests.app.served import serve, wait_for

LOST = "The server does not answer"


def value_of(page: Page, label: str) -> str:
    return page.get_by_role("combobox", name=label).input_value()


def test_one_drives_one_watches_and_control_changes_hands(browser: Browser) -> None:
    with serve("--paused", "--no-auto-next", "--no-tour") as served, open_page(browser, served.address) as first:
        expect(first.get_by_text("you drive, nobody watches")).to_be_visible()
        expect(button(first, "Take control")).to_be_hidden()
        with open_page(browser, served.address) as second:
            expect(second.get_by_text("Visitor 2: you watch, Visitor 1 drives, 1 watches")).to_be_visible()
            expect(first.get_by_text("you drive, 1 watches")).to_be_visible()
            wait_for_node(second, "/object/body")

            choose(second, "Object", "cube")
            expect(second.get_by_text("Visitor 1 drives and you watch.").first).to_be_visible()
            expect(second.get_by_role("combobox", name="Object")).to_have_value("sugar_box")
            second.get_by_role("checkbox", name="Auto next").check(force=True)
            expect(second.get_by_role("checkbox", name="Auto next")).not_to_be_checked()
            assert served.state()["object"] == "sugar_box" and served.state()["tick"] == 0

            start = node_position(first, "/object/body")
            button(first, "Step").click()
            wait_for(served, lambda s: s["tick"] == 1)
            first.wait_for_function(
                "start => window.__viserMutable.nodeRefFromName['/object/body'].position.y !== start",
                arg=start and start[1],
            )
            place = node_position(first, "/object/body")
            second.wait_for_function(
                "place => window.__viserMutable.nodeRefFromName['/object/body'].position.y === place",
                arg=place and place[1],
            )

            button(second, "Take control").click()
            expect(second.get_by_text("you drive, 1 watches")).to_be_visible()
            expect(first.get_by_text("Visitor 2 drives now.")).to_be_visible()
            expect(first.get_by_text("you watch, Visitor 2 drives")).to_be_visible()
            choose(second, "Object", "cube")
            wait_for(served, lambda s: s["object"] == "cube" and not s["loading"])
            expect(first.get_by_role("combobox", name="Object")).to_have_value("cube")
            button(first, "Step").click()
            expect(first.get_by_text("Visitor 2 drives and you watch.").first).to_be_visible()
            assert served.state()["tick"] == 0
        expect(first.get_by_text("you drive, nobody watches")).to_be_visible()
        button(first, "Step").click()
        wait_for(served, lambda s: s["tick"] == 1)


def test_a_page_says_that_its_server_is_gone_and_goes_on_when_it_is_back(browser: Browser) -> None:
    with serve("--paused", "--no-tour") as before, open_page(browser, before.address) as page:
        expect(page.get_by_text("you drive")).to_be_visible()
        wait_for_node(page, "/object/body")
        before.process.send_signal(signal.SIGINT)
        before.process.wait(20.0)
        expect(page.get_by_role("alert").filter(has_text=LOST)).to_be_visible()
        port = before.authority.split(":")[1]
        with serve("--paused", "--no-tour", "--port", port, "--scenario", "ur5_linear_slab") as after:
            assert after.address == before.address
            wait_for_node(page, "/obstacles/slab", 40.0)
            expect(page.get_by_role("alert").filter(has_text=LOST)).to_be_hidden()
            expect(page.get_by_text("you drive")).to_be_visible()
            button(page, "Step").click()
            wait_for(after, lambda s: s["tick"] == 1)


def test_one_browser_too_many_is_told_so_and_let_in_when_there_is_room(browser: Browser) -> None:
    with serve("--paused", "--no-tour", "--max-clients", "1") as served:
        with open_page(browser, served.address) as first:
            wait_for_node(first, "/object/body")
            second = browser.new_page()
            second.goto(served.address)
            expect(second.get_by_text("One browser is open, and more are not served")).to_be_visible()
            expect(first.get_by_text("you drive, nobody watches")).to_be_visible()
        wait_for_node(second, "/object/body", 40.0)
        expect(second.get_by_role("alert").filter(has_text="not served")).to_be_hidden()
        second.close()


def test_the_page_breaks_none_of_its_own_rules_and_runs_nothing_that_is_slipped_in(browser: Browser) -> None:
    with serve("--paused", "--no-tour") as served, open_page(browser, "about:blank") as page:
        refused: list[str] = []
        page.on("console", lambda message: refused.append(message.text) if "Content Security" in message.text else None)
        page.goto(served.address)
        wait_for_node(page, "/object/body")
        expect(page.get_by_text("you drive")).to_be_visible()
        assert refused == []
        page.evaluate(
            """() => {
                const place = document.createElement("div");
                place.innerHTML = "<img src=x onerror='window.slipped = 1'><iframe src='http://evil.example'></iframe>";
                document.body.append(place);
                const script = document.createElement("script");
                script.textContent = "window.slipped = 2";
                document.body.append(script);
            }"""
        )
        page.wait_for_timeout(300)
        assert page.evaluate("window.slipped ?? 0") == 0
        assert len(refused) >= 2


def test_the_description_of_the_api_is_a_page_with_examples(browser: Browser) -> None:
    with serve("--paused") as served, open_page(browser, served.address + "api/docs") as page:
        expect(page.get_by_text("POST /api/v1/session/commands")).to_be_visible()
        expect(page.get_by_text("GET /api/v1/events")).to_be_visible()
        expect(page.get_by_text("curl -X POST").first).to_be_visible()
        page.get_by_role("link", name="Back to the dashboard").click()
        wait_for_node(page, "/object/body")
