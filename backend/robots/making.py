"""Makes a robot's model files: URDFs for physics, page and lifts, and the spheres that planners see."""

from __future__ import annotations

import copy
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import trimesh

from backend.pose import Array, Pose
from backend.robots.description import RobotDescription
from backend.robots.meshes import link_meshes, numbers, origin
from backend.robots.shapes import ConvexPiece, convex_pieces, hull_mesh, surface_points
from backend.robots.sources import RobotSource, compile_urdf
from backend.robots.spheres import cover

SPACING_M = 3e-3
MOST_PIECES = 3
LEAST_GAIN = 0.08
"""A cut must save this part of a link's hull."""
FRAME_MASS_KG = 1e-3
"""For links without inertial data, which PyBullet would otherwise make 1 kg."""
ARM_EXCESS_M = 0.02
HAND_EXCESS_M = 0.01
"""How far the planner's spheres may stick out of a link's collision shape."""
LEAST_INERTIA_KGM2 = 1e-4
"""What a geared finger drive reflects onto its links; lighter ones make the gripper's gear constraints ring."""


def make_model(description: RobotDescription, source: RobotSource, root: Path, folder: Path) -> None:
    """Write ``collision.urdf``, ``visual.urdf``, ``hand.urdf``, ``spheres.npz``, ``model.json`` and their meshes.

    Mesh paths are relative to the folder, so that it can be made aside and moved into place.
    """
    robot = compile_urdf(source, root)
    visual, collision = robot, copy.deepcopy(robot)
    spheres: dict[str, Array] = {}
    (folder / "meshes").mkdir(parents=True)
    for index, (seen, solid) in enumerate(zip(visual.findall("link"), collision.findall("link"), strict=True)):
        name = str(seen.get("name"))
        parts = list(link_meshes(seen, source.default_rgba))
        repair_inertial(seen)
        repair_inertial(solid)
        _replace_geometry(seen, "visual", [])
        _replace_geometry(seen, "collision", [])
        _replace_geometry(solid, "visual", [])
        if not parts:
            continue
        points = np.concatenate([surface_points(mesh, SPACING_M, seed=0) for mesh, _ in parts])
        rng = np.random.default_rng(index)
        pieces = convex_pieces(rng.choice(points, min(len(points), 3000), replace=False), MOST_PIECES, LEAST_GAIN)
        excess_m = HAND_EXCESS_M if name in description.gripper.hand_links else ARM_EXCESS_M
        spheres[name] = cover(points, pieces, excess_m, rng)
        _write_visual(seen, name, parts, folder)
        _write_collision(solid, name, pieces, folder)
    ET.ElementTree(visual).write(folder / "visual.urdf")
    ET.ElementTree(collision).write(folder / "collision.urdf")
    hand, T_handroot_tcp = hand_alone(collision, description)
    ET.ElementTree(hand).write(folder / "hand.urdf")
    np.savez(folder / "spheres.npz", **spheres)  # pyright: ignore[reportArgumentType]
    (folder / "model.json").write_text(json.dumps({"T_handroot_tcp": T_handroot_tcp.matrix.tolist()}))


def repair_inertial(link: ET.Element) -> None:
    """Give a link without mass a small one, and light links enough inertia for stable constraints."""
    inertial = link.find("inertial")
    if inertial is None:
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "mass", value=str(FRAME_MASS_KG))
        ET.SubElement(inertial, "inertia", ixx="0", iyy="0", izz="0", ixy="0", ixz="0", iyz="0")
    inertia = inertial.find("inertia")
    if inertia is None:
        raise ValueError(f"{link.get('name')}: an inertial without inertia")
    for axis in ("ixx", "iyy", "izz"):
        inertia.set(axis, repr(max(float(inertia.get(axis, "0")), LEAST_INERTIA_KGM2)))


def hand_alone(robot: ET.Element, description: RobotDescription) -> tuple[ET.Element, Pose]:
    """(URDF of the hand's links only, T_handroot_tcp). The root is the hand link nearest to the arm."""
    names = set(description.gripper.hand_links)
    joints = {_end(joint, "child"): joint for joint in robot.findall("joint")}
    roots = [name for name in names if _end(joints[name], "parent") not in names]
    if len(roots) != 1:
        raise ValueError(f"{description.name}: the hand links have {len(roots)} roots, not one: {sorted(roots)}")
    hand = ET.Element("robot", name=f"{description.name}_hand")
    hand.extend(copy.deepcopy(link) for link in robot.findall("link") if link.get("name") in names)
    hand.extend(copy.deepcopy(joint) for name, joint in joints.items() if name in names - set(roots))
    T_root_tcp = _fixed_chain(joints, roots[0]).inverse() @ _fixed_chain(joints, description.flange_link)
    return hand, T_root_tcp @ description.T_flange_tcp


def _fixed_chain(joints: dict[str, ET.Element], link: str) -> Pose:
    """Pose of a link in the frame of the nearest link above it (or itself) that a movable joint carries."""
    pose = Pose.identity()
    while link in joints and joints[link].get("type") == "fixed":
        pose = origin(joints[link]) @ pose
        link = _end(joints[link], "parent")
    return pose


def _end(joint: ET.Element, which: str) -> str:
    element = joint.find(which)
    if element is None:
        raise ValueError(f"joint {joint.get('name')} has no {which}")
    return str(element.get("link"))


def _write_visual(
    link: ET.Element, name: str, parts: list[tuple[trimesh.Trimesh, tuple[float, ...]]], folder: Path
) -> None:
    by_color: dict[tuple[float, ...], list[trimesh.Trimesh]] = {}
    for mesh, rgba in parts:
        by_color.setdefault(rgba, []).append(mesh)
    for i, (rgba, meshes) in enumerate(by_color.items()):
        merged = trimesh.Trimesh(
            *trimesh.util.append_faces([m.vertices for m in meshes], [m.faces for m in meshes]), process=False
        )
        path = folder / "meshes" / f"{name}_visual_{i}.ply"
        merged.export(path)
        visual = _add_mesh(link, "visual", path)
        material = ET.SubElement(visual, "material", name=f"{name}_{i}")
        ET.SubElement(material, "color", rgba=" ".join(f"{v:g}" for v in rgba))


def _write_collision(link: ET.Element, name: str, pieces: list[ConvexPiece], folder: Path) -> None:
    box = link.find("collision/geometry/box")
    if box is not None and numbers(box.get("size", "")):
        return
    _replace_geometry(link, "collision", [])
    for i, piece in enumerate(pieces):
        path = folder / "meshes" / f"{name}_hull_{i}.obj"
        hull_mesh(piece).export(path, include_normals=False)
        _add_mesh(link, "collision", path)


def _replace_geometry(link: ET.Element, tag: str, by: list[ET.Element]) -> None:
    for element in link.findall(tag):
        link.remove(element)
    link.extend(by)


def _add_mesh(link: ET.Element, tag: str, path: Path) -> ET.Element:
    element = ET.SubElement(link, tag)
    ET.SubElement(ET.SubElement(element, "geometry"), "mesh", filename=f"meshes/{path.name}")
    return element
