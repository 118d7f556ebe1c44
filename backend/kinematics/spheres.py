"""SphereModel: the collision spheres of one robot, grouped by link, riding on the bodies of its chain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.chain import Chain, body_rows, matrix_of
from backend.kinematics.sphere_tree import sphere_tree
from backend.kinematics.urdf import LinkTree
from backend.pose import Array, inverse

if TYPE_CHECKING:
    from backend.robots.description import GripperDescription, RobotDescription

Integers = NDArray[np.int64]

HAND = 1
"""Flag of a group: it belongs to the hand."""
LEVEL = 2
"""Flag of a group: its height never changes, so the floor it stands on is no obstacle to it."""


@dataclass(frozen=True, eq=False)
class SphereModel:
    """Spheres of one opening of the hand. One group per link that has spheres."""

    names: tuple[str, ...]
    """(g,) link of every group."""
    spheres: Array
    """(n, 4) x, y, z, radius in the body's frame, group after group."""
    nodes: Array
    """(m, 4) one tree per group, see ``sphere_tree``; in the body's frame."""
    skips: Integers
    """(m,) the node after each node's subtree; -1 at leaves."""
    trees: Integers
    """(g, 4) body, first node, one past the last node, flags."""
    index: Integers
    """(g, 3) body, first sphere, one past the last sphere."""
    pairs: Integers
    """(p, 2) groups that must not touch each other."""
    description: RobotDescription
    tree: LinkTree
    chain: Chain
    spheres_of_link: dict[str, Array]

    @staticmethod
    def build(
        description: RobotDescription,
        tree: LinkTree,
        chain: Chain,
        spheres_of_link: dict[str, Array],
        gripper_rad: float | None = None,
    ) -> SphereModel:
        """Group the links' spheres (n, 4, link frames) with the hand at ``gripper_rad``, open when None."""
        names = tuple(link for link in tree.links if len(spheres_of_link.get(link, ())))
        opening = description.gripper.open_rad if gripper_rad is None else gripper_rad
        Ts_body_link = _links_in_bodies(tree, chain, hand_joints(description.gripper, opening))
        moved = [_moved(Ts_body_link[name], spheres_of_link[name]) for name in names]
        stops = np.cumsum([len(spheres) for spheres in moved])
        flags = [_flags(description, chain, name) for name in names]
        bodies = [chain.body_of_link[name] for name in names]
        starts = stops - [len(spheres) for spheres in moved]
        nodes, skips = zip(*(sphere_tree(spheres) for spheres in moved), strict=True)
        ends = np.cumsum([len(tree) for tree in nodes])
        begins = ends - [len(tree) for tree in nodes]
        shifted = [np.where(skip < 0, -1, skip + begin) for skip, begin in zip(skips, begins, strict=True)]
        return SphereModel(
            names=names,
            spheres=np.ascontiguousarray(np.concatenate(moved)),
            index=np.column_stack([bodies, starts, stops]).astype(np.int64),
            nodes=np.concatenate(nodes),
            skips=np.concatenate(shifted),
            trees=np.column_stack([bodies, begins, ends, flags]).astype(np.int64),
            pairs=_self_pairs(description, names, bodies),
            description=description,
            tree=tree,
            chain=chain,
            spheres_of_link=spheres_of_link,
        )

    def with_gripper(self, gripper_rad: float) -> SphereModel:
        """The same robot with the hand at ``gripper_rad``."""
        return SphereModel.build(self.description, self.tree, self.chain, self.spheres_of_link, gripper_rad)

    def world(self, frames: Array) -> Array:
        """(n, 4) spheres in the world, given the body frames (dof + 2, 12)."""
        out = self.spheres.copy()
        for body, start, stop in self.index:
            out[start:stop] = _moved(matrix_of(frames[body]), self.spheres[start:stop])
        return out


def hand_joints(gripper: GripperDescription, master_rad: float) -> dict[str, float]:
    """Value of every joint of the hand when its master joint stands at ``master_rad``."""
    coupled = {part.joint: part.multiplier * master_rad for part in (*gripper.gears, *gripper.followers)}
    return {gripper.master_joint: master_rad, **coupled}


def _links_in_bodies(tree: LinkTree, chain: Chain, joints_rad: dict[str, float]) -> dict[str, Array]:
    frames = matrix_of(body_rows(chain.links, np.zeros(chain.dof)))
    poses = tree.link_poses(joints_rad)
    return {link: inverse(frames[chain.body_of_link[link]]) @ T for link, T in poses.items()}


def _moved(T: Array, spheres: Array) -> Array:
    return np.column_stack([spheres[:, :3] @ T[:3, :3].T + T[:3, 3], spheres[:, 3]])


def _flags(description: RobotDescription, chain: Chain, name: str) -> int:
    body = chain.body_of_link[name]
    first_is_vertical = abs(abs(chain.links[0][8]) - 1.0) < 1e-9
    level = body == 0 or (body == 1 and first_is_vertical)
    return HAND * (name in description.gripper.hand_links) + LEVEL * level


def _self_pairs(description: RobotDescription, names: tuple[str, ...], bodies: list[int]) -> Integers:
    """Links of bodies that are neither the same nor neighbours, unless they are allowed to touch."""
    pairs = [
        (i, j)
        for i in range(len(names))
        for j in range(i)
        if abs(bodies[i] - bodies[j]) > 1 and frozenset({names[i], names[j]}) not in description.allowed_self_contacts
    ]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)
