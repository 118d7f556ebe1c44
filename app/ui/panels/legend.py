"""Legend: what the colours mean, and which layers are shown."""

from __future__ import annotations

import viser

from app.ui.layers.layer import Layer
from app.ui.words import legend


def add_legend(gui: viser.GuiApi, layers: list[Layer]) -> None:
    """The colours of all layers, and a check box for each layer."""
    with gui.add_folder("Legend"):
        gui.add_html(legend([row for layer in layers for row in layer.swatches]))
    with gui.add_folder("Show", expand_by_default=False):
        for layer in layers:
            _add_switch(gui, layer)


def _add_switch(gui: viser.GuiApi, layer: Layer) -> None:
    switch = gui.add_checkbox(layer.title, True)
    switch.on_update(lambda event: layer.show(bool(event.target.value)))
