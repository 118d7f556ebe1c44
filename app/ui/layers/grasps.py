"""The shortlisted grasps as small hands at the predicted object, coloured by a score; the picked one a ghost hand."""

from __future__ import annotations

import numpy as np
import viser

from app.ui import palette
from app.ui.geometry import Geometry, gripper_glyph
from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.robot_parts import open_hand
from app.ui.scores import SCORES
from app.ui.touch import Touch
from backend.pipeline.values import Candidate, Shortlist
from backend.pose import Array, wxyz_from_rotation
from backend.robots import ROBOTS
from backend.snapshot import SceneDescription

GHOST = 0.55
"""Opacity of the hand at the picked grasp."""


class GraspsLayer:
    """All hands are one batched mesh in the predicted object's frame: a new prediction moves one node."""

    title = "Grasps"
    swatches: tuple[tuple[Rgb, str], ...] = (
        (palette.RANKS[0], "Best grasp"),
        (palette.RANKS[-1], "Last of shortlist"),
        (palette.PICKED, "Picked grasp"),
    )

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/grasps")
        self._glyph: Geometry = gripper_glyph(0.08)
        self._frame: viser.FrameHandle | None = None
        self._hands: viser.BatchedMeshHandle | None = None
        self._picked: viser.MeshHandle | None = None

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._glyph = gripper_glyph(ROBOTS[scene.robot].gripper.opening_m)
        self._frame = self._scene.add_frame(f"{self._root.name}/predicted", show_axes=False, visible=False)
        self._hands = self._add_hands(10)
        hand = open_hand(scene.robot)
        self._picked = self._scene.add_mesh_simple(
            f"{self._root.name}/predicted/picked",
            hand.vertices,
            hand.faces,
            color=palette.PICKED,
            opacity=GHOST,
            visible=False,
        )

    def draw(self, picture: Picture) -> None:
        cycle = picture.cycle
        if not picture.new_cycle or self._frame is None or self._picked is None:
            return
        if cycle is None:
            self._frame.visible = False
            return
        self._frame.visible = cycle.shortlist is not None
        if cycle.shortlist is not None:
            place(self._frame, cycle.shortlist.candidates.T_world_object)
            self._show_shortlist(cycle.shortlist, cycle.picked, SCORES[picture.view.grasps_by](cycle.shortlist))
        self._picked.visible = cycle.picked is not None
        if cycle.picked is not None:
            place(self._picked, cycle.picked.T_object_grasp)

    def show(self, visible: bool) -> None:
        self._root.show(visible)

    def _show_shortlist(self, shortlist: Shortlist, picked: Candidate | None, shades: list[Rgb]) -> None:
        """Unused instances of the batch are shrunk to nothing; the batch grows when it must."""
        kept = [i for i in shortlist.kept if picked is None or i != picked.index]
        if self._hands is None or len(kept) > len(self._hands.batched_positions):
            self._hands = self._add_hands(2 * len(kept))
        count = len(self._hands.batched_positions)
        scales, colors = np.zeros(count), np.zeros((count, 3), dtype=np.uint8)
        wxyzs, positions = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)), np.zeros((count, 3))
        Ts: Array = shortlist.candidates.Ts_object_grasp
        for slot, index in enumerate(kept):
            scales[slot] = 1.0
            positions[slot] = Ts[index, :3, 3]
            wxyzs[slot] = wxyz_from_rotation(Ts[index, :3, :3])
            colors[slot] = shades[index]
        self._hands.batched_positions = positions.astype(np.float32)
        self._hands.batched_wxyzs = wxyzs.astype(np.float32)
        self._hands.batched_scales = scales.astype(np.float32)
        self._hands.batched_colors = colors

    def _add_hands(self, count: int) -> viser.BatchedMeshHandle:
        return self._scene.add_batched_meshes_simple(
            f"{self._root.name}/predicted/shortlist",
            self._glyph.vertices,
            self._glyph.faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            batched_positions=np.zeros((count, 3)),
            batched_scales=np.zeros(count, dtype=np.float32),
            batched_colors=np.zeros((count, 3), dtype=np.uint8),
            lod="off",
            opacity=0.85,
        )
