"""Chain: the serial joints from the base to the tcp as contiguous arrays, and their forward kinematics.

A transform is a row of 12 numbers, rotation row-major then position. Joints turn about their frame's z axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.kinematics.compiled import kernel
from backend.kinematics.urdf import LinkTree
from backend.pose import Array, Pose, inverse


@dataclass(frozen=True, eq=False)
class Chain:
    """One arm. Body 0 is the base, body i moves with joint i; body frames have the joint's axis as z."""

    links: Array
    """(dof + 1, 12) pose of body i + 1 in body i at joint value zero; last row: tcp in the last body."""
    body_of_link: dict[str, int]
    """The body every link of the robot is part of; the fingers belong to the last one."""

    @property
    def dof(self) -> int:
        return len(self.links) - 1

    @staticmethod
    def from_tree(tree: LinkTree, joints: tuple[str, ...], tcp_link: str, T_link_tcp: Pose) -> Chain:
        """The chain of ``joints`` (base to wrist, all revolute) with the tcp fixed to ``tcp_link``."""
        rows: list[Array] = []
        T_body_here = np.eye(4)
        for joint in tree.joints_to(tcp_link):
            T_body_here = T_body_here @ joint.T_parent_joint
            if joint.name in joints:
                align = _align_z(joint.axis)
                rows.append(row_of(T_body_here @ align))
                T_body_here = inverse(align)
        rows.append(row_of(T_body_here @ T_link_tcp.matrix))
        bodies = {link: _body_of(tree, joints, link) for link in tree.links}
        return Chain(np.array(rows), bodies)


def row_of(T: Array) -> Array:
    """(12,) row of a (4, 4) transform."""
    return np.concatenate([T[:3, :3].ravel(), T[:3, 3]])


def matrix_of(row: Array) -> Array:
    """(4, 4) transform of a (12,) row; (n, 4, 4) of (n, 12)."""
    out = np.zeros((*row.shape[:-1], 4, 4))
    out[..., :3, :3] = row[..., :9].reshape(*row.shape[:-1], 3, 3)
    out[..., :3, 3] = row[..., 9:]
    out[..., 3, 3] = 1.0
    return out


def rows_of(Ts: Array) -> Array:
    """(n, 12) rows of (n, 4, 4) transforms."""
    return np.concatenate([Ts[:, :3, :3].reshape(-1, 9), Ts[:, :3, 3]], axis=1)


def _align_z(axis: Array) -> Array:
    """(4, 4) rotation whose third column is ``axis``."""
    T = np.eye(4)
    if axis[2] != 1.0:
        other = np.eye(3)[int(np.argmin(np.abs(axis)))]
        x = np.cross(other, axis)
        x /= np.linalg.norm(x)
        T[:3, :3] = np.stack([x, np.cross(axis, x), axis], axis=1)
    return T


def _body_of(tree: LinkTree, joints: tuple[str, ...], link: str) -> int:
    return sum(joint.name in joints for joint in tree.joints_to(link))


@kernel
def compose(a: Array, b: Array, out: Array) -> None:
    """``out = a b`` for rows of 12."""
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]
        out[9 + i] = a[3 * i] * b[9] + a[3 * i + 1] * b[10] + a[3 * i + 2] * b[11] + a[9 + i]


@kernel
def move_bodies(links: Array, q: Array, frames: Array) -> None:
    """Fill ``frames`` (dof + 2, 12): pose in the world of the base, every body and, last, the tcp."""
    dof = q.shape[0]
    for k in range(12):
        frames[0, k] = 0.0
    frames[0, 0] = frames[0, 4] = frames[0, 8] = 1.0
    for i in range(dof):
        here = frames[i + 1]
        compose(frames[i], links[i], here)
        c, s = np.cos(q[i]), np.sin(q[i])
        for k in range(0, 9, 3):
            x, y = here[k], here[k + 1]
            here[k] = c * x + s * y
            here[k + 1] = c * y - s * x
    compose(frames[dof], links[dof], frames[dof + 1])


@kernel
def fill_jacobian(frames: Array, jacobian: Array) -> None:
    """Geometric Jacobian (6, dof) of the tcp in world axes: linear rows first, then angular."""
    dof = jacobian.shape[1]
    tcp = frames[dof + 1]
    for i in range(dof):
        body = frames[i + 1]
        ax, ay, az = body[2], body[5], body[8]
        rx, ry, rz = tcp[9] - body[9], tcp[10] - body[10], tcp[11] - body[11]
        jacobian[0, i] = ay * rz - az * ry
        jacobian[1, i] = az * rx - ax * rz
        jacobian[2, i] = ax * ry - ay * rx
        jacobian[3, i] = ax
        jacobian[4, i] = ay
        jacobian[5, i] = az


@kernel
def tcp_rows(links: Array, qs: Array) -> Array:
    """(n, 12) pose of the tcp for every row of ``qs`` (n, dof)."""
    out = np.empty((qs.shape[0], 12))
    frames = np.empty((qs.shape[1] + 2, 12))
    for i in range(qs.shape[0]):
        move_bodies(links, qs[i], frames)
        out[i] = frames[-1]
    return out


@kernel
def body_rows(links: Array, q: Array) -> Array:
    """(dof + 2, 12) pose of the base, every body and the tcp."""
    frames = np.empty((q.shape[0] + 2, 12))
    move_bodies(links, q, frames)
    return frames


@kernel
def jacobian_of(links: Array, q: Array) -> Array:
    """(6, dof) geometric Jacobian of the tcp."""
    frames = np.empty((q.shape[0] + 2, 12))
    jacobian = np.empty((6, q.shape[0]))
    move_bodies(links, q, frames)
    fill_jacobian(frames, jacobian)
    return jacobian
