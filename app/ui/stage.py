"""Stage: one world in the scene, drawn by every layer below one node."""

from __future__ import annotations

from dataclasses import replace

import viser

from app.reports import Sight
from app.ui.layers import LAYERS, Layer, Picture
from app.ui.looks import Looks
from app.ui.touch import Touch
from backend.pipeline.values import CycleResult
from backend.snapshot import SceneDescription, Snapshot


class Stage:
    """Draws nothing twice."""

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self.layers: tuple[Layer, ...] = tuple(layer(scene, touch, under) for layer in LAYERS)
        self._world: SceneDescription | None = None
        self._drawn: Snapshot | None = None
        self._cycle: CycleResult | None = None
        self._looks: Looks | None = None

    def begin(self, world: SceneDescription) -> None:
        """A new trial."""
        for layer in self.layers:
            layer.begin(world)
        self._world, self._drawn, self._cycle = world, None, None

    def draw(self, sight: Sight, looks: Looks) -> None:
        """A tick; nothing before the first trial."""
        if self._world is None or (sight.snapshot is self._drawn and looks == self._looks):
            return
        picture = Picture(self._world, sight.snapshot, sight.traces, True, looks)
        if picture.cycle is self._cycle and looks == self._looks:
            picture = replace(picture, new_cycle=False)
        for layer in self.layers:
            layer.draw(picture)
        self._drawn, self._cycle, self._looks = sight.snapshot, picture.cycle, looks

    def show(self, title: str, visible: bool) -> None:
        """Show or hide the layer of that title."""
        for layer in self.layers:
            if layer.title == title:
                layer.show(visible)
