"""Legend: from where and how the scene is seen, what its colours mean, and which layers are shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.ui.camera import PRESETS, CameraKeeper
from app.ui.desk import Desk
from app.ui.help import Guide
from app.ui.theme import DARK, LIGHT, Theme
from app.ui.words import legend
from app.ui.worlds import Worlds


def add_legend(gui: viser.GuiApi, worlds: Worlds, desk: Desk) -> None:
    """The colours of all layers, and a check box for each layer."""
    with gui.add_folder("Legend"):
        gui.add_html(legend([row for layer in worlds.layers for row in layer.swatches]))
    with gui.add_folder("Show", expand_by_default=False):
        for layer in worlds.layers:
            _add_switch(gui, layer.title, worlds, desk)


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


def _add_switch(gui: viser.GuiApi, title: str, worlds: Worlds, desk: Desk) -> None:
    switch, shown = gui.add_checkbox(title, True), True

    async def on_update(event: viser.GuiEvent[viser.GuiCheckboxHandle]) -> None:
        nonlocal shown
        if event.client is None:
            return
        if not desk.admits(event.client):
            switch.value = shown
            return
        shown = bool(event.target.value)
        worlds.show(title, shown)

    switch.on_update(on_update)
