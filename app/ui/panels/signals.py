"""Signals: plots of the last minute, which go along when somebody looks back."""

from __future__ import annotations

import time

import viser

from app.ui.desk import Desk
from app.ui.panels.panel import View
from app.ui.plot import plot_html
from app.ui.signals import plots
from app.ui.strip import span_s
from app.ui.words import tip
from backend.robots import ROBOTS

REDRAW_S = 1.0
"""While time passes; a moment looked at is shown at once."""
ABOUT = "Over the last minute; a click looks back at that moment. Figures are of the moment shown."


class SignalsPanel:
    """Display only; drawn anew once a second at most, and not at all while nothing changes."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        gui.add_html(tip(ABOUT))
        self._plots = gui.add_html("")
        self._shown: tuple[object, ...] = ()
        self._due_s = 0.0

    def show(self, view: View) -> None:
        looked_at, newest = view.live.looked_at, view.moments[-1] if view.moments else None
        paused = view.live.pace.paused
        if newest is None or (looked_at, newest) == self._shown:
            return
        if not paused and time.monotonic() < self._due_s:
            return
        self._shown, self._due_s = (looked_at, newest), time.monotonic() + REDRAW_S
        values = view.live.info.values
        limits_rps = ROBOTS[values.robot].profiles[values.profile].velocity_rps
        span, shown_s = span_s(view.moments), (looked_at or newest).t_s
        other = view.live.restart.compare or ""
        drawn = plots(view.moments, limits_rps, other)
        self._plots.content = "".join(plot_html(plot, span, shown_s, looked_at is not None) for plot in drawn)
