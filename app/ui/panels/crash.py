"""Crash: what happened to the simulation process, and the button that starts it again."""

from __future__ import annotations

from collections.abc import Callable

import viser

from app.reports import Crashed
from app.ui.desk import Answer, Desk
from app.ui.panels.panel import View
from app.ui.words import crash_text

LABEL = "Restart simulation"


class CrashPanel:
    """A modal while the process is down; the button stays in the panel when somebody closes the modal."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._gui = gui
        self._desk = desk
        self._close_modal: Callable[[], None] | None = None
        self._shown: Crashed | None = None
        self._button = self._add_button(visible=False)

    def show(self, view: View) -> None:
        crash = view.state.crash
        if crash is self._shown:
            return
        self._shown = crash
        self._button.visible = crash is not None
        if self._close_modal is not None:
            self._close_modal()
            self._close_modal = None
        if crash is not None:
            modal = self._gui.add_modal("The simulation has ended")
            self._close_modal = modal.close
            with modal:
                self._gui.add_html(crash_text(crash.cause, crash.traceback))
                self._add_button(visible=True)

    def restart(self) -> Answer:
        """Start a new process with the trial that was running."""
        self._desk.restart()
        return "The simulation was started again."

    def _add_button(self, visible: bool) -> viser.GuiButtonHandle:
        button = self._gui.add_button(LABEL, color="red", icon=viser.Icon.REFRESH, visible=visible)
        button.on_click(lambda event: self._desk.wish("revive", self.restart, event.client))
        return button
