"""Stage: one world in the scene, drawn by every layer below one node."""

from __future__ import annotations

from dataclasses import replace

import viser

from app.reports import Sight
from app.ui.layers import LAYERS, Layer, Picture
from app.ui.touch import Touch
from app.view import SharedView
from backend.knowledge.reach_profile import ReachProfile
from backend.pipeline.values import CycleResult
from backend.snapshot import SceneDescription, Snapshot


class Stage:
    """Draws nothing twice."""

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._layers: tuple[Layer, ...] = tuple(layer(scene, touch, under) for layer in LAYERS)
        self._world: SceneDescription | None = None
        self._reach: ReachProfile | None = None
        self._drawn: Snapshot | None = None
        self._cycle: CycleResult | None = None
        self._view: SharedView | None = None

    def begin(self, world: SceneDescription, view: SharedView, reach: ReachProfile | None = None) -> None:
        """A new trial."""
        self._show(view)
        for layer in self._layers:
            layer.begin(world)
        self._world, self._reach, self._drawn, self._cycle = world, reach, None, None

    def draw(self, sight: Sight, view: SharedView) -> None:
        """A tick; nothing before the first trial."""
        if self._world is None or (sight.snapshot is self._drawn and view == self._view):
            return
        self._show(view)
        picture = Picture(self._world, sight.snapshot, sight.traces, True, self._reach, view)
        if picture.cycle is self._cycle and view == self._view:
            picture = replace(picture, new_cycle=False)
        for layer in self._layers:
            layer.draw(picture)
        self._drawn, self._cycle, self._view = sight.snapshot, picture.cycle, view

    def _show(self, view: SharedView) -> None:
        for layer in self._layers:
            layer.show(layer.title not in view.hidden)
