"""Legend: what the scene's colours mean, and which of its layers are shown."""

from __future__ import annotations

from functools import partial

import viser

from app.ui.desk import Answer, Desk
from app.ui.layers import LAYERS
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.words import legend
from backend.knowledge.reach_profile import GRASP_KINDS, HIGHEST_M


class LegendPanel:
    """The colours of all layers, and a check box for each layer."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        with gui.add_folder("Legend"):
            gui.add_html(legend([row for layer in LAYERS for row in layer.swatches]))
        with gui.add_folder("Show", expand_by_default=False):
            hidden = desk.session.state.view.hidden
            self._boxes = {layer.title: gui.add_checkbox(layer.title, layer.title not in hidden) for layer in LAYERS}
            self._kind = gui.add_dropdown("Reach of", GRASP_KINDS, hint="Grasps that the slice of reach is for")
            self._height = gui.add_slider("Height cm", 0, 100 * HIGHEST_M, 1, 10, hint="Of the slice of reach")
        for title, box in self._boxes.items():
            box.on_update(choosing(desk, f"layer {title}", partial(self.set_layer, title)))
        self._kind.on_update(choosing(desk, "reach of", self.set_kind))
        self._height.on_update(choosing(desk, "reach height", self.set_height_cm))

    def show(self, view: View) -> None:
        for title, box in self._boxes.items():
            self._desk.mirror(f"layer {title}", box, title not in view.state.view.hidden)
        self._desk.mirror("reach of", self._kind, view.state.view.reach_of)
        self._desk.mirror("reach height", self._height, round(100.0 * view.state.view.reach_height_m))

    def set_kind(self, kind: object) -> Answer:
        """Slice another kind of grasps' reach, and show it."""
        self._desk.change_view(reach_of=kind)
        return self.set_layer("Reach", True)

    def set_height_cm(self, height_cm: float) -> Answer:
        """Slice at another height, and show it."""
        self._desk.change_view(reach_height_m=height_cm / 100.0)
        return self.set_layer("Reach", True)

    def set_layer(self, title: str, shown: object) -> Answer:
        """Show a layer or hide it."""
        self._desk.session.change_view(lambda view: view.with_layer(title, bool(shown)))
        return None
