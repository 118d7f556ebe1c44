"""The bodies around the robot: the object to be grasped, the obstacles, the slab."""

from __future__ import annotations

from functools import partial

import numpy as np
import viser

from app.ui import palette
from app.ui.geometry import Geometry, creased
from app.ui.layers.draggable import make_draggable
from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.touch import Touch
from backend.objects import ObjectDescription, load_object
from backend.pose import Array
from backend.snapshot import SceneDescription, Snapshot


def add_object(
    scene: viser.SceneApi, name: str, shape: ObjectDescription, color: Rgb, opacity: float | None = None
) -> viser.MeshHandle:
    """Add the visual mesh of an object, in the object's frame."""
    geometry: Geometry = creased(shape.visual.as_trimesh())
    return scene.add_mesh_simple(name, geometry.vertices, geometry.faces, color=color, opacity=opacity)


class ObjectLayer:
    """The object to be grasped, where it truly is."""

    title = "Object"
    swatches: tuple[tuple[Rgb, str], ...] = ()

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/object")
        self._node: viser.MeshHandle | None = None

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        shape = load_object(scene.object)
        self._node = add_object(self._scene, f"{self._root.name}/body", shape, shape.color_rgb)

    def draw(self, picture: Picture) -> None:
        if self._node is not None:
            place(self._node, picture.snapshot.T_world_object)

    def show(self, visible: bool) -> None:
        self._root.show(visible)


class ObstaclesLayer:
    """What must not be knocked."""

    title = "Obstacles"
    swatches: tuple[tuple[Rgb, str], ...] = ((palette.SLAB, "Slab"),)

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/obstacles")
        self._touch = touch
        self._nodes: list[viser.MeshHandle] = []
        self._held: set[int] = set()
        self._yaws_rad: list[float] = []
        self._drawn: Snapshot | None = None
        """The snapshot whose obstacles and slab the nodes are."""

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._drawn = None

    def _put_up(self, snapshot: Snapshot) -> None:
        self._root.clear()
        self._drawn = snapshot
        self._nodes, self._held, self._yaws_rad = [], set(), [0.0] * len(snapshot.obstacles)
        for i, name in enumerate(snapshot.obstacles):
            shape = load_object(name)
            node = add_object(self._scene, f"{self._root.name}/{i}", shape, shape.color_rgb)
            make_draggable(node, self._touch.may, partial(self._hold, i), partial(self._drop, i))
            self._nodes.append(node)
        if snapshot.slab is not None:
            slab = self._scene.add_box(
                f"{self._root.name}/slab", color=palette.SLAB, dimensions=snapshot.slab.size_m, opacity=0.6
            )
            place(slab, snapshot.slab.T_world_box)

    def draw(self, picture: Picture) -> None:
        if self._drawn is None or not picture.snapshot.stands_as(self._drawn):
            self._put_up(picture.snapshot)
        for i, (node, T) in enumerate(zip(self._nodes, picture.snapshot.Ts_world_obstacle, strict=True)):
            self._yaws_rad[i] = float(np.arctan2(T[1, 0], T[0, 0]))
            if i not in self._held:
                place(node, T)

    def _hold(self, index: int, held: bool) -> None:
        """What somebody has in hand is not put back by the next tick."""
        (self._held.add if held else self._held.discard)(index)

    def _drop(self, index: int, place_m: Array, client: viser.ClientHandle) -> None:
        x_m, y_m = place_m.tolist()
        self._touch.obstacle(index, x_m, y_m, self._yaws_rad[index], client)

    def show(self, visible: bool) -> None:
        self._root.show(visible)
