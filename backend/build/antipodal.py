"""Grasp candidates from geometry: pairs of facing surface points, approached from everywhere but below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray

from backend.objects.description import ObjectDescription
from backend.pose import Array
from backend.robots.description import RobotDescription

FACING = float(np.cos(np.radians(20.0)))
"""Least cosine between the closing direction and both surface normals: within the pads' friction cone."""
POINTS = 1200
CLEARANCE_M = 0.008
"""The open hand is at least this much wider than what it closes on."""
DEPTH_M = 0.012
"""Along the approach, the pads' middle lies at most this far from what they close on."""
MOST_UPWARD = 0.05
"""Largest z of an approach direction: the object stands on its tray."""


@dataclass(frozen=True)
class Band:
    """A range of approach directions, by how steeply they go down."""

    name: str
    low: float
    high: float
    """Range of ``-z`` of the approach direction."""

    def holds(self, approach: Array) -> bool:
        """Whether a unit vector (3,) is in the band."""
        return self.low <= -approach[2] < self.high


BANDS = (Band("side", -MOST_UPWARD, 0.35), Band("oblique", 0.35, 0.85), Band("top", 0.85, 1.01))


class AntipodalSampler:
    """Draws grasps (tcp in the object frame) of one object for one hand."""

    def __init__(self, robot: RobotDescription, target: ObjectDescription, rng: np.random.Generator) -> None:
        self._rng = rng
        self._hand = robot.gripper
        sampled = trimesh.sample.sample_surface(target.visual.as_trimesh(), POINTS, seed=int(rng.integers(2**31)))
        points, faces = np.asarray(sampled[0]), np.asarray(sampled[1])
        self._points = np.asarray(points, dtype=np.float64)
        self._pairs = self._facing(target.visual.face_normals[faces])
        self._weights = self._near_mass(target.center_of_mass_m, target.height_m)

    def __len__(self) -> int:
        """How many pairs of points face each other."""
        return len(self._pairs)

    def draw(self, band: Band) -> Array | None:
        """One (4, 4) grasp whose approach lies in the band; None when this pair allows none."""
        i, j = self._pairs[self._rng.choice(len(self._pairs), p=self._weights)]
        if self._rng.random() < 0.5:
            i, j = j, i
        closing = self._points[j] - self._points[i]
        closing /= np.linalg.norm(closing)
        for _ in range(8):
            approach = self._across(closing)
            if band.holds(approach):
                depth_m = self._rng.uniform(-DEPTH_M, DEPTH_M)
                return _grasp((self._points[i] + self._points[j]) / 2 - depth_m * approach, closing, approach)
        return None

    def _facing(self, normals: Array) -> NDArray[np.int64]:
        """(n, 2) indices of points whose normals point apart along the line that joins them."""
        between = self._points[None] - self._points[:, None]
        width = np.linalg.norm(between, axis=2)
        np.fill_diagonal(width, np.inf)
        direction = between / width[..., None]
        outwards_i = -np.einsum("ijk,ik->ij", direction, normals)
        outwards_j = np.einsum("ijk,jk->ij", direction, normals)
        most = self._hand.opening_m - CLEARANCE_M
        i, j = np.nonzero((width < most) & (width > 0.01) & (outwards_i > FACING) & (outwards_j > FACING))
        return np.stack([i, j], axis=1)[i < j]

    def _near_mass(self, center_of_mass: Array, height_m: float) -> Array:
        """(n,) chances of the pairs: weight far from the grip turns in it, so pairs near it come oftener."""
        middle = self._points[self._pairs].mean(axis=1)
        distance = np.linalg.norm(middle - center_of_mass, axis=1)
        weights = np.exp(-distance / max(0.04, 0.3 * height_m))
        return weights / weights.sum()

    def _across(self, closing: Array) -> Array:
        """(3,) a random unit vector at right angles to ``closing``."""
        vector = self._rng.normal(size=3)
        vector -= vector @ closing * closing
        return vector / np.linalg.norm(vector)


def _grasp(tcp: Array, closing: Array, approach: Array) -> Array:
    T = np.eye(4)
    T[:3, :3] = np.column_stack([np.cross(closing, approach), closing, approach])
    T[:3, 3] = tcp
    return T
