"""Task: what the task's own model and the sensing's can be set to."""

from __future__ import annotations

import viser

from app.ui.desk import Desk
from app.ui.fields import FieldsOf
from app.ui.panels.panel import View
from app.ui.panels.settings import SettingsGroup


class TaskPanel:
    """Everything here restarts the trial."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._of_task, self._of_sensing = FieldsOf("task"), FieldsOf("sensing")
        self._task = SettingsGroup(gui, desk, "Task (restarts)", expanded=False)
        self._sensing = SettingsGroup(gui, desk, "Sensing (restarts)", expanded=False)

    def show(self, view: View) -> None:
        values = view.state.info.values
        self._task.show(field for field in self._of_task.of(values) if field.path != "task.kind")
        self._sensing.show(self._of_sensing.of(values))
