"""HandPoints: the open hand's surface as points in the tcp frame, for fast collision tests of candidates."""

from __future__ import annotations

from pathlib import Path
from typing import cast
from xml.etree import ElementTree

import numpy as np
import trimesh

from backend.kinematics.spheres import hand_joints
from backend.kinematics.urdf import LinkTree
from backend.pose import Array
from backend.robots.meshes import numbers, origin
from backend.robots.models import RobotModel

SPACING_M = 0.007


def hand_points(model: RobotModel) -> Array:
    """(n, 3) points about ``SPACING_M`` apart on the open hand's collision shapes, in the tcp frame, metres."""
    gripper = model.description.gripper
    tree = LinkTree.from_urdf(model.hand_urdf)
    poses = tree.link_poses(hand_joints(gripper, gripper.open_rad))
    T_tcp_root = model.T_handroot_tcp.inverse().matrix
    points: list[Array] = []
    for link in ElementTree.parse(model.hand_urdf).getroot().findall("link"):
        T_tcp_link = T_tcp_root @ poses[str(link.get("name"))]
        for shape in link.findall("collision"):
            T = T_tcp_link @ origin(shape).matrix
            mesh = _mesh(shape, model.hand_urdf.parent)
            count = max(24, int(4 * mesh.area / SPACING_M**2))
            drawn = np.concatenate([mesh.vertices, trimesh.sample.sample_surface(mesh, count, seed=0)[0]])
            points.append(drawn @ T[:3, :3].T + T[:3, 3])
    return _thinned(np.concatenate(points))


def _mesh(shape: ElementTree.Element, folder: Path) -> trimesh.Trimesh:
    box, mesh = shape.find("geometry/box"), shape.find("geometry/mesh")
    if box is not None:
        return trimesh.creation.box(numbers(str(box.get("size"))))
    assert mesh is not None
    return cast(trimesh.Trimesh, trimesh.load(folder / str(mesh.get("filename")), force="mesh"))


def _thinned(points: Array) -> Array:
    """One point per cell of half the spacing."""
    cells = np.round(points / (0.5 * SPACING_M)).astype(np.int64)
    return points[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
