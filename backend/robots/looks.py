"""What a robot looks like: coloured meshes per link, and the tree that says where the links are."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

import trimesh

from backend.kinematics.urdf import LinkTree
from backend.looks import Geometry, creased, joined, moved, thinned
from backend.pose import inverse
from backend.robots.models import load_model

Rgb = tuple[int, int, int]

CELL_M = 0.001
"""Detail finer than this costs a browser without a graphics card more than it shows."""


@dataclass(frozen=True, eq=False)
class LinkPart:
    """One mesh of one colour, in its link's frame."""

    link: str
    geometry: Geometry
    color: Rgb


@dataclass(frozen=True, eq=False)
class RobotParts:
    """Everything needed to draw a robot."""

    tree: LinkTree
    parts: tuple[LinkPart, ...]


@cache
def load_robot_parts(robot: str) -> RobotParts:
    """Read the visual model of a registered robot, once per process; raises ``NotFoundError``."""
    path = load_model(robot).visual_urdf
    links = ET.parse(path).getroot().findall("link")
    parts = [part for link in links for part in _parts_of(link, path.parent)]
    return RobotParts(LinkTree.from_urdf(path), tuple(parts))


@cache
def open_hand(robot: str) -> Geometry:
    """The open hand of a registered robot as one mesh in the tcp frame; raises ``NotFoundError``."""
    description, drawn = load_model(robot).description, load_robot_parts(robot)
    gripper = description.gripper
    followers = {coupled.joint: coupled.multiplier for coupled in (*gripper.gears, *gripper.followers)}
    multipliers = {gripper.master_joint: 1.0, **followers}
    poses = drawn.tree.link_poses({joint: m * gripper.open_rad for joint, m in multipliers.items()})
    T_tcp_root = inverse(poses[description.flange_link] @ description.T_flange_tcp.matrix)
    hand = [part for part in drawn.parts if part.link in gripper.hand_links]
    return joined(*(moved(part.geometry, T_tcp_root @ poses[part.link]) for part in hand))


def _parts_of(link: ET.Element, folder: Path) -> list[LinkPart]:
    parts: list[LinkPart] = []
    for visual in link.findall("visual"):
        mesh, color = visual.find("geometry/mesh"), visual.find("material/color")
        if mesh is None or color is None:
            continue
        loaded = cast(trimesh.Trimesh, cast(Any, trimesh).load_mesh(folder / str(mesh.get("filename"))))
        parts.append(
            LinkPart(str(link.get("name")), creased(thinned(loaded, CELL_M)), _screen_color(str(color.get("rgba"))))
        )
    return parts


def _screen_color(rgba: str) -> Rgb:
    """The files' linear light as the screen wants it (gamma 2.2)."""
    red, green, blue = (round(255 * float(word) ** (1 / 2.2)) for word in rgba.split()[:3])
    return red, green, blue
