"""Pose: the only rigid-transform type. ``T_a_b`` is the pose of frame b seen from frame a."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid transform, held as a homogeneous 4x4 matrix that nobody can write to."""

    matrix: Array
    """(4, 4), metres; the upper left 3x3 is a rotation."""

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if matrix.shape != (4, 4) or not math.isfinite(np.add.reduce(matrix, axis=None)):
            raise ValueError(f"A pose is a finite 4x4 matrix, not {matrix!r}")
        matrix.flags.writeable = False
        object.__setattr__(self, "matrix", matrix)

    @staticmethod
    def identity() -> Pose:
        return Pose(np.eye(4))

    @staticmethod
    def of(xyz_m: ArrayLike = (0.0, 0.0, 0.0), wxyz: ArrayLike = (1.0, 0.0, 0.0, 0.0)) -> Pose:
        """Pose from a position and a unit quaternion (normalised here)."""
        x, y, z = np.asarray(xyz_m, dtype=np.float64).tolist()
        a, b, c = _rows_from_wxyz(np.asarray(wxyz, dtype=np.float64))
        return Pose(np.array([[*a, x], [*b, y], [*c, z], [0.0, 0.0, 0.0, 1.0]]))

    @staticmethod
    def from_xyz_rpy(xyz_m: ArrayLike, rpy_rad: ArrayLike) -> Pose:
        """Pose from fixed-axis roll, pitch, yaw: ``Rz(yaw) Ry(pitch) Rx(roll)``, URDF's convention."""
        matrix = np.eye(4)
        matrix[:3, :3] = rotation_from_rpy(np.asarray(rpy_rad, dtype=np.float64))
        matrix[:3, 3] = xyz_m
        return Pose(matrix)

    @staticmethod
    def from_xyz_yaw(xyz_m: ArrayLike, yaw_rad: float) -> Pose:
        """Upright pose turned by ``yaw_rad`` about the vertical."""
        return Pose.from_xyz_rpy(xyz_m, (0.0, 0.0, yaw_rad))

    @cached_property
    def xyz_m(self) -> Array:
        """(3,) position."""
        return self.matrix[:3, 3]

    @cached_property
    def rotation(self) -> Array:
        """(3, 3) rotation matrix."""
        return self.matrix[:3, :3]

    @cached_property
    def wxyz(self) -> Array:
        """(4,) unit quaternion with w >= 0."""
        return wxyz_from_rotation(self.rotation)

    @property
    def yaw_rad(self) -> float:
        """Heading of the x axis in the horizontal plane, in (-pi, pi]."""
        return float(np.arctan2(self.matrix[1, 0], self.matrix[0, 0]))

    def inverse(self) -> Pose:
        return Pose(inverse(self.matrix))

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.matrix @ other.matrix)

    def transform_points(self, points: Array) -> Array:
        """Points (n, 3) in frame b, as points (n, 3) in frame a."""
        return points @ self.rotation.T + self.xyz_m


def inverse(T: Array) -> Array:
    """Inverse of one (4, 4) or many (n, 4, 4) rigid transforms."""
    out = np.zeros_like(T)
    rotation_T = np.swapaxes(T[..., :3, :3], -1, -2)
    out[..., :3, :3] = rotation_T
    out[..., :3, 3] = -np.einsum("...ij,...j->...i", rotation_T, T[..., :3, 3])
    out[..., 3, 3] = 1.0
    return out


def rotation_from_rpy(rpy_rad: Array) -> Array:
    """(3, 3) rotation ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy_rad), np.cos(rpy_rad)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rotation_from_wxyz(wxyz: Array) -> Array:
    """(3, 3) rotation of a quaternion of any non-zero length."""
    return np.array(_rows_from_wxyz(wxyz))


def _rows_from_wxyz(wxyz: Array) -> tuple[list[float], list[float], list[float]]:
    """The same as plain numbers, on which Python is quicker than numpy."""
    w, x, y, z = (wxyz / math.sqrt(wxyz.dot(wxyz))).tolist()
    return (
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    )


def wxyz_from_rotation(rotation: Array) -> Array:
    """(4,) unit quaternion with w >= 0 of a (3, 3) rotation (largest-component method, Shepperd 1978)."""
    (a, ab, ac), (ba, b, bc), (ca, cb, c) = rotation.tolist()
    squares = (1 + a + b + c, 1 + a - b - c, 1 - a + b - c, 1 - a - b + c)
    i = squares.index(max(squares))
    s = math.sqrt(squares[i])
    wx, wy, wz = cb - bc, ac - ca, ba - ab
    xy, xz, yz = ab + ba, ac + ca, bc + cb
    rows = ((s * s, wx, wy, wz), (wx, s * s, xy, xz), (wy, xy, s * s, yz), (wz, xz, yz, s * s))
    q = np.array(rows[i]) / (2 * s)
    return q if q[0] >= 0 else -q


def rotation_angle_rad(a: Array, b: Array) -> float:
    """Angle in [0, pi] of the rotation that turns (3, 3) ``a`` into (3, 3) ``b``."""
    delta = a.T @ b
    sine = np.linalg.norm([delta[2, 1] - delta[1, 2], delta[0, 2] - delta[2, 0], delta[1, 0] - delta[0, 1]])
    return float(np.arctan2(sine, np.trace(delta) - 1.0))
