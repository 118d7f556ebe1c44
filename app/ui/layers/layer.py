"""Layer: one thing in the 3-D scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import viser

from app.reports import Traces
from app.ui.palette import Rgb
from app.ui.touch import Touch
from app.view import SharedView
from backend.knowledge.reach_profile import ReachProfile
from backend.pipeline.values import CycleResult, Phase
from backend.pose import Array, Pose
from backend.snapshot import SceneDescription, Snapshot

ON_THE_WAY: tuple[Phase, ...] = ("watch", "move", "approach")


@dataclass(frozen=True, eq=False)
class Picture:
    """What is to be seen now."""

    scene: SceneDescription
    snapshot: Snapshot
    traces: Traces | None
    new_cycle: bool
    """The cycle or its traces have not been drawn before, or are to look otherwise."""
    reach: ReachProfile | None = None
    view: SharedView = field(default_factory=SharedView)

    @property
    def cycle(self) -> CycleResult | None:
        """The newest cycle, as long as the arm is on its way by it: what was thought before the grasp is over then."""
        return self.snapshot.cycle if self.snapshot.phase in ON_THE_WAY else None


class Layer(Protocol):
    """Builds its nodes once per trial, then only moves and recolours them."""

    title: str
    """One of ``LayerName``; label of its check box, at most 14 characters."""
    swatches: tuple[tuple[Rgb, str], ...]
    """Its rows of the legend."""

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None: ...

    def begin(self, scene: SceneDescription) -> None:
        """A new trial."""
        ...

    def draw(self, picture: Picture) -> None:
        """A new tick."""
        ...

    def show(self, visible: bool) -> None: ...


class Root:
    """The invisible parent of a layer's nodes."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        self.name = name
        self._scene = scene
        self._frame = scene.add_frame(name, show_axes=False)

    def clear(self) -> None:
        """Remove everything below, keeping the visibility."""
        visible = self._frame.visible
        self._frame.remove()
        self._frame = self._scene.add_frame(self.name, show_axes=False, visible=visible)

    def show(self, visible: bool) -> None:
        self._frame.visible = visible


def place(node: Any, T: Pose | Array) -> None:
    """Move a scene node to a pose, given as a ``Pose`` or (4, 4)."""
    pose = T if isinstance(T, Pose) else Pose(T)
    node.position = pose.xyz_m
    node.wxyz = pose.wxyz
