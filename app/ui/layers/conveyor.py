"""The conveyor: the belt's way with its direction, the tray, and the place where the robot stands."""

from __future__ import annotations

import numpy as np
import viser

from app.ui import palette
from app.ui.geometry import chevrons, ribbon, ring
from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.touch import Touch
from backend.pose import Array
from backend.snapshot import SceneDescription

ARROW_SPACING_M = 0.1
BELOW_TRAY_M = 0.002


class ConveyorLayer:
    """Belt and tray."""

    title = "Conveyor"
    swatches: tuple[tuple[Rgb, str], ...] = ((palette.BELT, "Belt"),)

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/conveyor")
        self._tray: viser.BoxHandle | None = None
        self._arrows: viser.LineSegmentsHandle | None = None
        self._strokes: tuple[Array, Array] | None = None
        self._forward = True

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        path, (length_m, width_m, height_m) = scene.belt_path_world, scene.tray_size_m
        band = ribbon(path, width_m, height_m - BELOW_TRAY_M)
        self._scene.add_mesh_simple(
            f"{self._root.name}/belt", band.vertices, band.faces, color=palette.BELT, side="double"
        )
        lift_m = BELOW_TRAY_M * 2 - height_m
        arrow = {"spacing_m": ARROW_SPACING_M, "size_m": width_m / 5, "lift_m": lift_m}
        self._strokes = chevrons(path, **arrow), chevrons(path[::-1], **arrow)
        self._forward = True
        self._arrows = self._scene.add_line_segments(
            f"{self._root.name}/arrows", self._strokes[0], palette.BELT_ARROW, thickness=2.0, thickness_units="screen"
        )
        self._tray = self._scene.add_box(
            f"{self._root.name}/tray", color=palette.TRAY, dimensions=(length_m, width_m, height_m)
        )
        self._mark_base()

    def draw(self, picture: Picture) -> None:
        if self._tray is None or self._arrows is None or self._strokes is None:
            return
        T_tray_middle = picture.snapshot.T_world_tray.matrix.copy()
        T_tray_middle[:3, 3] -= T_tray_middle[:3, 2] * picture.scene.tray_size_m[2] / 2
        place(self._tray, T_tray_middle)
        forward = picture.snapshot.belt_rate >= 0.0
        if forward != self._forward:
            self._forward = forward
            self._arrows.points = self._strokes[0 if forward else 1].astype(np.float32)

    def show(self, visible: bool) -> None:
        self._root.show(visible)

    def _mark_base(self) -> None:
        mark = ring(0.11, 0.125, 0.001)
        self._scene.add_mesh_simple(f"{self._root.name}/base", mark.vertices, mark.faces, color=palette.BASE)
