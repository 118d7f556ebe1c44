"""What each browser chooses for itself: camera, light or dark, help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.ui.camera import PRESETS, CameraKeeper
from app.ui.help import Guide
from app.ui.theme import DARK, LIGHT, Theme


def add_view_switches(gui: viser.GuiApi, camera: CameraKeeper, theme: Theme, guide: Guide) -> None:
    """Camera presets, light or dark, and help: each for the browser that asks only."""
    with gui.add_folder("View"):
        presets = gui.add_button_group("Camera", PRESETS, hint="Keys 1 to 4")
        colors = gui.add_button_group("Colours", (LIGHT, DARK), hint="Of this browser only; key L")
        help_button = gui.add_button("Help and keys", icon=viser.Icon.HELP, color="gray")

    @presets.on_click
    def _(event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        if event.client is not None:
            camera.go(event.client, event.target.value)

    @colors.on_click
    def _(event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        if event.client is not None:
            theme.choose(event.client, dark=event.target.value == DARK)

    @help_button.on_click
    def _(event: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
        if event.client is not None:
            guide.help(event.client)

    for number, name in enumerate(PRESETS, start=1):
        _add_key(gui, f"Camera: {name.lower()}", str(number), lambda client, name=name: camera.go(client, name))
    _add_key(gui, "Light or dark", "L", theme.toggle)
    _add_key(gui, "Help and keys", "H", guide.help)


def _add_key(gui: viser.GuiApi, label: str, key: Any, act: Callable[[viser.ClientHandle], None]) -> None:
    command = gui.add_command(label, hotkey=key)
    command.on_trigger(lambda event: act(event.client) if event.client else None)
