"""LinkTree: links, joints and forward kinematics of a URDF, without any library."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from backend.errors import InvalidInputError, lookup
from backend.pose import Array, Pose

MOVABLE = frozenset({"revolute", "continuous", "prismatic"})


@dataclass(frozen=True, eq=False)
class Joint:
    """One joint of a URDF."""

    name: str
    kind: str
    """URDF's joint type: ``fixed``, ``revolute``, ``continuous`` or ``prismatic``."""
    parent: str
    child: str
    T_parent_joint: Array
    """(4, 4) pose of the child link at joint value zero."""
    axis: Array
    """(3,) unit vector in the joint frame."""
    lower: float
    """rad or m; -inf where the file gives no limit."""
    upper: float

    @property
    def movable(self) -> bool:
        return self.kind in MOVABLE

    def motion(self, value: float) -> Array:
        """(4, 4) pose of the child link in the parent link at joint value ``value`` (rad or m)."""
        if not self.movable or value == 0.0:
            return self.T_parent_joint
        out = np.eye(4)
        if self.kind == "prismatic":
            out[:3, 3] = self.axis * value
        else:
            skew, skew_squared = self._skews
            out[:3, :3] += math.sin(value) * skew + (1.0 - math.cos(value)) * skew_squared
        return self.T_parent_joint @ out

    @cached_property
    def _skews(self) -> tuple[Array, Array]:
        x, y, z = self.axis
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        return skew, skew @ skew


@dataclass(frozen=True, eq=False)
class LinkTree:
    """The links of one robot and the joints between them."""

    root: str
    joints: tuple[Joint, ...]
    """Parents before children."""

    @staticmethod
    def from_urdf(path: Path) -> LinkTree:
        """Read a URDF file; raise ``InvalidInputError`` when its joints are not one tree."""
        robot = ElementTree.parse(path).getroot()
        links = [str(link.get("name")) for link in robot.findall("link")]
        joints = [_joint(element) for element in robot.findall("joint")]
        roots = sorted(set(links) - {joint.child for joint in joints})
        if len(roots) != 1:
            raise InvalidInputError(f"{path}: a robot has one root link, this one has {roots}")
        return LinkTree(roots[0], _parents_first(roots[0], joints))

    @property
    def links(self) -> tuple[str, ...]:
        """Every link, parents before children."""
        return (self.root, *(joint.child for joint in self.joints))

    def joint(self, name: str) -> Joint:
        """The joint called ``name``; raises ``NotFoundError``."""
        return lookup("joint", name, self._by_name)

    def joints_to(self, link: str) -> tuple[Joint, ...]:
        """The joints from the root to ``link``, in order; raises ``NotFoundError``."""
        if link == self.root:
            return ()
        joint = lookup("link", link, self._by_child)
        return (*self.joints_to(joint.parent), joint)

    def link_poses(self, joints_rad: dict[str, float]) -> dict[str, Array]:
        """(4, 4) pose of every link in the root link; joints that are not named stand at zero."""
        poses = {self.root: np.eye(4)}
        for joint in self.joints:
            poses[joint.child] = poses[joint.parent] @ joint.motion(joints_rad.get(joint.name, 0.0))
        return poses

    @cached_property
    def _by_name(self) -> dict[str, Joint]:
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def _by_child(self) -> dict[str, Joint]:
        return {joint.child: joint for joint in self.joints}


def _parents_first(root: str, joints: list[Joint]) -> tuple[Joint, ...]:
    """Breadth first from the root, in the file's order among siblings."""
    ordered: list[Joint] = []
    frontier = [root]
    while frontier:
        parent = frontier.pop(0)
        below = [joint for joint in joints if joint.parent == parent]
        ordered.extend(below)
        frontier.extend(joint.child for joint in below)
    return tuple(ordered)


def _joint(element: ElementTree.Element) -> Joint:
    axis = _floats(element.find("axis"), "xyz", "1 0 0")
    norm = float(np.linalg.norm(axis))
    origin = element.find("origin")
    limit = element.find("limit")
    kind = str(element.get("type"))
    bounds: Mapping[str, str] = limit.attrib if limit is not None and kind != "continuous" else {}
    return Joint(
        name=str(element.get("name")),
        kind=kind,
        parent=_link_of(element, "parent"),
        child=_link_of(element, "child"),
        T_parent_joint=Pose.from_xyz_rpy(_floats(origin, "xyz", "0 0 0"), _floats(origin, "rpy", "0 0 0")).matrix,
        axis=axis / norm if norm > 0.0 else axis,
        lower=float(bounds.get("lower", -math.inf)),
        upper=float(bounds.get("upper", math.inf)),
    )


def _link_of(joint: ElementTree.Element, role: str) -> str:
    element = joint.find(role)
    if element is None:
        raise InvalidInputError(f"Joint {joint.get('name')!r} has no {role} link")
    return str(element.get("link"))


def _floats(element: ElementTree.Element | None, key: str, default: str) -> Array:
    text = default if element is None else element.get(key, default)
    return np.array([float(word) for word in text.split()])
