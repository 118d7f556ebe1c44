"""The arm and its hand, with their real shapes."""

from __future__ import annotations

import viser

from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.robot_parts import RobotParts, load_robot_parts
from app.ui.touch import Touch
from backend.snapshot import SceneDescription


class RobotLayer:
    """One node per link, moved by the joints of the snapshot."""

    title = "Robot"
    swatches: tuple[tuple[Rgb, str], ...] = ()

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/robot")
        self._robot = ""
        self._parts: RobotParts | None = None
        self._links: dict[str, viser.FrameHandle] = {}

    def begin(self, scene: SceneDescription) -> None:
        if scene.robot == self._robot:
            return
        self._root.clear()
        self._robot = scene.robot
        self._parts = load_robot_parts(scene.robot)
        drawn = dict.fromkeys(part.link for part in self._parts.parts)
        self._links = {link: self._scene.add_frame(f"{self._root.name}/{link}", show_axes=False) for link in drawn}
        for i, part in enumerate(self._parts.parts):
            self._scene.add_mesh_simple(
                f"{self._root.name}/{part.link}/{i}", part.geometry.vertices, part.geometry.faces, color=part.color
            )

    def draw(self, picture: Picture) -> None:
        if self._parts is None:
            return
        poses = self._parts.tree.link_poses(picture.snapshot.joints_rad)
        for link, node in self._links.items():
            place(node, poses[link])

    def show(self, visible: bool) -> None:
        self._root.show(visible)
