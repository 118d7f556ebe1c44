"""Method: which occupant each room of the pipeline has, and its settings; whatever the models offer is here."""

from __future__ import annotations

from collections.abc import Iterable

import viser

from app.ui.contenders import NOTHING
from app.ui.desk import Answer, Desk
from app.ui.fields import Field, FieldsOf
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.panels.settings import SettingsGroup
from app.ui.words import tip

FLAT = ("choice", "switch")
"""What is short enough to stand above the folders."""
ROOMS = ("predictor", "horizon", "filter", "planner", "retimer", "execution")


class MethodPanel:
    """Everything here restarts the trial."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        state = desk.session.state
        gui.add_html(tip("Every change restarts the trial with the same seed."))
        names = desk.session.engine.method_names()
        self._preset = gui.add_dropdown(
            "Method", names, initial_value=state.info.method, hint="A whole method; what is set below changes it"
        )
        self._compare = gui.add_dropdown(
            "Compare with",
            (NOTHING, *names),
            initial_value=state.restart.compare or NOTHING,
            hint="The same trial under another method, beside this one and in step with it",
        )
        self._preset.on_update(self._on_preset)
        self._compare.on_update(choosing(desk, "compare", self.set_compare))
        self._rooms = SettingsGroup(gui, desk, "Rooms")
        self._arm = SettingsGroup(gui, desk, "Arm and time")
        self._folders = {room: SettingsGroup(gui, desk, room.capitalize(), expanded=False) for room in ROOMS}
        self._of_method, self._of_profile, self._of_timing = map(FieldsOf, ("method", "profile", "timing"))

    def show(self, view: View) -> None:
        values = view.state.info.values
        self._desk.mirror("method", self._preset, view.state.info.method)
        self._desk.mirror("compare", self._compare, view.state.restart.compare or NOTHING)
        fields = self._of_method.of(values)
        self._rooms.show(flat(fields))
        self._arm.show((*self._of_profile.of(values), *self._of_timing.of(values)))
        for room, folder in self._folders.items():
            folder.show(f for f in fields if f.group == f"method.{room}" and f.sort not in FLAT)

    def set_method(self, name: str) -> Answer:
        """Restart with another method as it is listed."""
        self._desk.restart(overrides={"method": name})
        return f"Restarted with method {name}."

    def set_compare(self, name: str) -> Answer:
        """Restart with another method beside the one that runs, or with that alone."""
        if name == NOTHING:
            self._desk.compare(None)
            return "Restarted without comparison."
        self._desk.compare(name)
        return f"Restarted with {name} beside it."

    async def _on_preset(self, event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
        if event.client is not None:  # None: set by ``show``
            name = event.target.value
            self._desk.wish("method", lambda: self.set_method(name), event.client)


def flat(fields: Iterable[Field]) -> tuple[Field, ...]:
    """Kinds and switches of all rooms."""
    return tuple(field for field in fields if field.sort in FLAT)
