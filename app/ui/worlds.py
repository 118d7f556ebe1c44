"""Worlds: the running trial in the scene, and beside it the one it is compared with, each under its caption."""

from __future__ import annotations

from typing import Any

import viser

from app.reports import Sight, Started
from app.state import SessionState
from app.ui.camera import beside_m
from app.ui.contenders import Contender, contenders
from app.ui.stage import Stage
from app.ui.touch import Touch
from app.view import SharedView

HERE, BESIDE = "/here", "/beside"
CAPTION_M = 0.9
"""Captions hang this high above the robots' bases."""


class Worlds:
    """What belongs to a comparison is built with the first and taken down when nothing is compared any more."""

    def __init__(self, scene: viser.SceneApi, touch: Touch) -> None:
        self._scene = scene
        self._touch = touch
        self._first = Stage(scene, touch)
        self._second: Stage | None = None
        self._frames: list[viser.FrameHandle] = []
        """Where the two worlds stand."""
        self._captions: list[viser.LabelHandle] = []
        self._said: tuple[Contender, ...] = ()

    def begin(self, started: Started, view: SharedView) -> None:
        """A new trial."""
        self._first.begin(started.scene, view, started.reach)
        shift_m = beside_m(started)
        if shift_m is None:
            self._take_down()
            return
        if self._second is None:
            self._second = self._build()
        self._frames[1].position = shift_m
        self._second.begin(started.scene, view)

    def draw(self, state: SessionState) -> None:
        """A tick of either world."""
        if state.snapshot is None:
            return
        self._first.draw(Sight(state.snapshot, state.traces), state.view)
        if self._second is None or state.beside is None:
            return
        self._second.draw(state.beside, state.view)
        said = contenders(state)
        if said != self._said:
            self._said = said
            for caption, contender in zip(self._captions, said, strict=True):
                caption.text = contender.words

    def _build(self) -> Stage:
        self._frames = [self._scene.add_frame(name, show_axes=False) for name in (HERE, BESIDE)]
        looks: dict[str, Any] = {
            "position": (0.0, 0.0, CAPTION_M),
            "anchor": "bottom-center",
            "font_screen_scale": 1.25,
        }
        self._captions = [self._scene.add_label(f"{frame.name}/caption", "", **looks) for frame in self._frames]
        self._said = ()
        return Stage(self._scene, self._touch, BESIDE)

    def _take_down(self) -> None:
        for frame in self._frames:
            frame.remove()
        self._second, self._frames, self._captions = None, [], []
