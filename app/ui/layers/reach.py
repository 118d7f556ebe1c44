"""Reach: a level slice through what the arm reaches, for grasps from above or from the side."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from app.ui import palette
from app.ui.layers.layer import Picture, Root
from app.ui.palette import Rgb, blend
from app.ui.touch import Touch
from backend.knowledge.reach_profile import GraspKind, ReachProfile
from backend.pose import Array
from backend.snapshot import SceneDescription

PIXELS = 480
DEEP_M = 0.2
"""So far inside counts as fully inside."""
BORDER_M = 0.008
FAINT, STRONG = 70, 200
"""Opacity of the reachable, of 255, and of its border."""
SHADES: tuple[Rgb, ...] = (palette.REACH_EDGE, palette.REACH)


class ReachLayer:
    """One image in the world, drawn again when another slice is asked for."""

    title = "Reach"
    swatches: tuple[tuple[Rgb, str], ...] = ((palette.REACH, "In reach, a slice"),)

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/reach")
        self._image: viser.ImageHandle | None = None
        self._drawn: tuple[ReachProfile, GraspKind, float] | None = None
        self._visible = True

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._image, self._drawn = None, None

    def draw(self, picture: Picture) -> None:
        if picture.reach is None or not self._visible:
            return
        wanted = picture.reach, picture.view.reach_of, picture.view.reach_height_m
        if wanted == self._drawn:
            return
        self._drawn = wanted
        pixels = slice_image(*wanted)
        if self._image is None:
            side_m = 2.0 * float(picture.reach.radius_m[-1])
            name = f"{self._root.name}/slice"
            self._image = self._scene.add_image(
                name, pixels, side_m, side_m, format="png", cast_shadow=False, receive_shadow=False
            )
        else:
            self._image.image = pixels
        self._image.position = (0.0, 0.0, picture.view.reach_height_m)

    def show(self, visible: bool) -> None:
        self._visible = visible
        self._root.show(visible)


def slice_image(reach: ReachProfile, kind: GraspKind, height_m: float) -> NDArray[np.uint8]:
    """(PIXELS, PIXELS, 4) of the square around the base: deeper inside is bluer, outside is nothing."""
    half_m = float(reach.radius_m[-1])
    middle = (np.arange(PIXELS) + 0.5) / PIXELS * 2.0 * half_m - half_m
    radius_m: Array = np.hypot(middle[:, None], middle[None])
    inside_m = np.interp(radius_m, reach.radius_m, reach.at(kind, height_m), right=-np.inf)
    steps = np.array([blend(SHADES, share) for share in np.linspace(0.0, 1.0, 33)], dtype=np.uint8)
    pixels = np.zeros((PIXELS, PIXELS, 4), dtype=np.uint8)
    pixels[..., :3] = steps[np.clip(inside_m / DEEP_M * 32, 0, 32).astype(np.int64)]
    pixels[..., 3] = np.where(inside_m > 0.0, np.where(inside_m < BORDER_M, STRONG, FAINT), 0)
    return pixels
