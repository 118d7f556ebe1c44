"""Who: tells each browser whether it drives or watches, and lets it take control."""

from __future__ import annotations

import threading
from collections.abc import Callable
from html import escape

import viser

from app.people import NotDrivingError, People, Visitor
from app.ui.palette import ANCHOR, QUIET, css

TAKE = "Take control"
FIRST = -1e6
"""Order of what stands above all else."""
NOTICE_S = 6.0


class Seat:
    """One browser's own line, and the button below it."""

    def __init__(self, client: viser.ClientHandle, visitor: Visitor, take: Callable[[Visitor], None]) -> None:
        self.visitor = visitor
        self._client = client
        self._shown = ""
        self._line = client.gui.add_html("", order=FIRST)
        self._button = client.gui.add_button(
            TAKE, order=FIRST + 1, icon=viser.Icon.STEERING_WHEEL, visible=False, hint="Drive instead of whoever does"
        )

        async def on_click(_: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
            take(visitor)

        self._button.on_click(on_click)

    def show(self, people: People) -> None:
        """Who drives now."""
        driver, watching = people.driver, people.watching
        html = line_html(self.visitor, driver, watching)
        if html != self._shown:
            self._shown = html
            self._line.content = html
            self._button.visible = driver is not None and driver != self.visitor

    def tell(self, text: str) -> None:
        """A notification in this browser."""
        self._client.add_notification("Control", text, auto_close_seconds=NOTICE_S, color="blue")


class Who:
    """The browsers that are here, by viser's number for each."""

    def __init__(self, people: People) -> None:
        self._people = people
        self._lock = threading.Lock()
        self._seats: dict[int, Seat] = {}
        self._driver: Visitor | None = None

    def arrive(self, client: viser.ClientHandle) -> None:
        """A browser has come."""
        seat = Seat(client, self._people.arrive(), self._people.take)
        with self._lock:
            self._seats[client.client_id] = seat
        seat.show(self._people)

    def leave(self, client: viser.ClientHandle) -> None:
        """A browser has gone."""
        with self._lock:
            seat = self._seats.pop(client.client_id, None)
        if seat is not None:
            self._people.leave(seat.visitor)

    def objection(self, client: viser.ClientHandle) -> NotDrivingError | None:
        """Why this browser's commands are not obeyed; None when they are."""
        with self._lock:
            seat = self._seats.get(client.client_id)
        if seat is None:
            return NotDrivingError("This page is just closing or opening: try again.")
        try:
            self._people.admit(seat.visitor)
        except NotDrivingError as error:
            return error
        return None

    def show(self) -> None:
        """A few times a second: every browser's line; a change of driver is told to the others."""
        with self._lock:
            seats = list(self._seats.values())
        for seat in seats:
            seat.show(self._people)
        driver, before = self._people.driver, self._driver
        if driver is None or driver == before:
            return
        self._driver = driver
        for seat in seats:
            if before is not None and seat.visitor != driver:
                seat.tell(f"{driver.name} drives now.")


def line_html(visitor: Visitor, driver: Visitor | None, watching: int) -> str:
    """HTML that says who this page is, who drives and how many watch; it carries the page's key for its script."""
    watch = "nobody watches" if watching == 0 else "1 watches" if watching == 1 else f"{watching} watch"
    if driver is None:
        what, color = "nobody drives, use any control to", css(QUIET)
    elif driver == visitor:
        what, color = f"you drive, {watch}", ANCHOR
    else:
        what, color = f"you watch, {driver.name} drives, {watch}", css(QUIET)
    return (
        f'<div data-visitor="{escape(visitor.key)}" style="margin:2px 12px;font-size:0.8em;color:{color};'
        f'font-weight:600">{escape(visitor.name)}: {escape(what)}</div>'
    )
