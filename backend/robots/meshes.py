"""The meshes of a URDF's links, in link frames and metres, with their colours."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import numpy as np
import trimesh

from backend.pose import Pose
from backend.robots.collada import Rgba, read_collada

GREY: Rgba = (0.7, 0.7, 0.7, 1.0)


def link_meshes(link: ET.Element, default: Rgba | None) -> Iterator[tuple[trimesh.Trimesh, Rgba]]:
    """Every visual mesh of the link; meshes without a colour of their own get ``default`` or the URDF's."""
    for visual in link.findall("visual"):
        geometry = visual.find("geometry")
        if geometry is None:
            continue
        T_link_visual = origin(visual).matrix
        for mesh, rgba in _read(geometry):
            mesh.apply_transform(T_link_visual)
            yield mesh, rgba or default or _urdf_color(visual)


def origin(element: ET.Element) -> Pose:
    """The pose written in an element's ``<origin>``; identity without one."""
    found = element.find("origin")
    if found is None:
        return Pose.identity()
    return Pose.from_xyz_rpy(numbers(found.get("xyz", "0 0 0")), numbers(found.get("rpy", "0 0 0")))


def numbers(text: str) -> list[float]:
    """The numbers of a URDF attribute."""
    return [float(word) for word in text.split()]


def _read(geometry: ET.Element) -> list[tuple[trimesh.Trimesh, Rgba | None]]:
    box, mesh = geometry.find("box"), geometry.find("mesh")
    if box is not None:
        return [(trimesh.creation.box(numbers(box.get("size", ""))), None)]
    if mesh is None:
        return []
    path = Path(mesh.get("filename", ""))
    scale = np.diag([*numbers(mesh.get("scale", "1 1 1")), 1.0])
    parts: list[tuple[trimesh.Trimesh, Rgba | None]] = []
    if path.suffix.lower() == ".dae":
        parts += read_collada(path)
    else:
        parts.append((cast(trimesh.Trimesh, trimesh.load(path, force="mesh")), None))
    for part, _ in parts:
        part.apply_transform(scale)
    return parts


def _urdf_color(visual: ET.Element) -> Rgba:
    color = visual.find("material/color")
    if color is None:
        return GREY
    r, g, b, a = numbers(color.get("rgba", ""))
    return r, g, b, a
