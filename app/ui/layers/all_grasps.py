"""Every grasp of the database as a small hand, coloured by the chosen score; a click shows its card."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.ui import palette
from app.ui.geometry import gripper_glyph
from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.scores import SCORES
from app.ui.touch import Touch
from backend.pipeline.values import Shortlist
from backend.pose import wxyz_from_rotation
from backend.robots import ROBOTS
from backend.snapshot import SceneDescription

SCALE = 0.3
BACK_M = 0.07
"""Small hands stand this far back from where they would grasp, so that they are seen around the object."""


class AllGraspsLayer:
    """One batched mesh in the predicted object's frame, as long as the database, made with the first cycle."""

    title = "All grasps"
    swatches: tuple[tuple[Rgb, str], ...] = ((palette.QUIET, "Other grasps"), (palette.BAD, "Out of reach"))

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._touch = touch
        self._root = Root(scene, under + "/all_grasps")
        self._robot = ""
        self._frame: viser.FrameHandle | None = None
        self._hands: viser.BatchedMeshHandle | None = None
        self._shown: dict[str, NDArray[Any]] = {}

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._robot = scene.robot
        self._frame = self._scene.add_frame(f"{self._root.name}/predicted", show_axes=False, visible=False)
        self._hands, self._shown = None, {}

    def draw(self, picture: Picture) -> None:
        if not picture.new_cycle or self._frame is None:
            return
        cycle = picture.cycle
        short = cycle.shortlist if cycle else None
        self._frame.visible = short is not None
        if cycle is None or short is None:
            return
        place(self._frame, short.candidates.T_world_object)
        Ts, chosen = short.candidates.Ts_object_grasp, picture.view.grasp
        scales = np.full(len(Ts), SCALE, dtype=np.float32)
        scales[list(short.kept)] = 0.0  # the shortlist is shown full-size by its own layer
        positions = (Ts[:, :3, 3] - BACK_M * Ts[:, :3, 2]).astype(np.float32)
        if chosen is not None and chosen < len(Ts):
            scales[chosen], positions[chosen] = 1.0, Ts[chosen, :3, 3]
        colors = np.array(SCORES[picture.view.grasps_by](short), dtype=np.uint8)
        self._paint(short, {"batched_scales": scales, "batched_positions": positions, "batched_colors": colors})

    def show(self, visible: bool) -> None:
        self._root.show(visible)

    def _paint(self, short: Shortlist, looks: dict[str, NDArray[Any]]) -> None:
        """Send only what is different: mostly one cycle ranks as the one before."""
        if self._hands is None:
            self._hands, self._shown = self._add(short), {}
        for name, values in looks.items():
            if name not in self._shown or not np.array_equal(self._shown[name], values):
                setattr(self._hands, name, values)
        self._shown = looks

    def _add(self, short: Shortlist) -> viser.BatchedMeshHandle:
        glyph = gripper_glyph(ROBOTS[self._robot].gripper.opening_m)
        Ts, n = short.candidates.Ts_object_grasp, len(short.score)
        hands = self._scene.add_batched_meshes_simple(
            f"{self._root.name}/predicted/hands",
            glyph.vertices,
            glyph.faces,
            batched_wxyzs=np.array([wxyz_from_rotation(T[:3, :3]) for T in Ts]),
            batched_positions=Ts[:, :3, 3],
            batched_scales=np.zeros(n, dtype=np.float32),
            batched_colors=np.zeros((n, 3), dtype=np.uint8),
            lod="off",
            opacity=0.5,
        )

        async def on_click(event: viser.SceneNodePointerEvent[viser.BatchedMeshHandle]) -> None:
            if event.instance_index is not None:
                self._touch.grasp(event.instance_index, event.client)

        hands.on_click(on_click)
        return hands
