"""Legend: what the scene's colours mean, and which of its layers are shown."""

from __future__ import annotations

from functools import partial

import viser

from app.ui.desk import Answer, Desk
from app.ui.layers import LAYERS
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.words import legend


class LegendPanel:
    """The colours of all layers, and a check box for each layer."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        with gui.add_folder("Legend"):
            gui.add_html(legend([row for layer in LAYERS for row in layer.swatches]))
        with gui.add_folder("Show", expand_by_default=False):
            self._boxes = {layer.title: gui.add_checkbox(layer.title, True) for layer in LAYERS}
        for title, box in self._boxes.items():
            box.on_update(choosing(desk, f"layer {title}", partial(self.set_layer, title)))

    def show(self, view: View) -> None:
        for title, box in self._boxes.items():
            self._desk.mirror(f"layer {title}", box, title not in view.state.view.hidden)

    def set_layer(self, title: str, shown: object) -> Answer:
        """Show a layer or hide it."""
        self._desk.session.change_view(lambda view: view.with_layer(title, bool(shown)))
        return None
