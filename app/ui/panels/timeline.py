"""Timeline: the last minute, looked back at, and gone on from."""

from __future__ import annotations

import time

import viser

from app.commands import GoOn, LookBack
from app.ui.contenders import contenders
from app.ui.desk import Answer, Desk, checked
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.strip import span_s, strip_svg
from backend.errors import lookup

REDRAW_S = 1.0
"""While time passes; a moment looked at is shown at once."""
STEP_S = 0.1
GO_ON, NEWEST = "Go on from here", "Back to newest"


class TimelinePanel:
    """The strip, and the slider below it that walks along it."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        self._strip = gui.add_html(strip_svg((), None))
        self._slider = gui.add_slider(
            "Time, s", 0.0, 15.0, STEP_S, 0.0, hint="Look back at the last 60 s; this pauses the trial"
        )
        self._buttons = gui.add_button_group(
            "Past",
            (GO_ON, NEWEST),
            hint="Repeat the trial up to the moment shown, edits included, and play on from there",
            visible=False,
        )
        self._slider.on_update(choosing(desk, "look", self.look_back))
        self._buttons.on_click(choosing(desk, "past", self.press))
        self._shown: tuple[object, ...] = ()
        self._due_s = 0.0

    def show(self, view: View) -> None:
        looked_at, newest = view.live.looked_at, view.moments[-1] if view.moments else None
        self._buttons.visible = looked_at is not None
        compared = contenders(view.state)
        key = (looked_at, newest if view.live.pace.paused else view.live.started, compared)
        if key == self._shown and (view.live.pace.paused or time.monotonic() < self._due_s):
            return
        self._shown, self._due_s = key, time.monotonic() + REDRAW_S
        shown_s = looked_at.t_s if looked_at else None
        self._strip.content = strip_svg(view.moments, shown_s, compared)
        self._slider.min, self._slider.max = (round(t_s, 1) for t_s in span_s(view.moments))
        now_s = newest.t_s if newest else 0.0
        self._desk.mirror("look", self._slider, round(now_s if shown_s is None else shown_s, 1))

    def look_back(self, t_s: float) -> Answer:
        """Pause, and show what was then."""
        self._desk.send(checked(LookBack, t_s=t_s))
        return None

    def press(self, label: str) -> Answer:
        """Raises ``NotFoundError`` for a button that is not there."""
        return lookup("button", label, {GO_ON: self.go_on, NEWEST: self.newest})()

    def go_on(self) -> Answer:
        """From the moment looked at."""
        state = self._desk.session.state
        self._desk.send(GoOn())
        t_s = state.looked_at.t_s if state.looked_at else 0.0
        return f"Going on from {t_s:.1f} s."

    def newest(self) -> Answer:
        """Stop looking back."""
        self._desk.send(LookBack(t_s=None))
        return None
