"""Path (waypoints, no time) and Trajectory (timed), in joint space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backend.pose import Array


@dataclass(frozen=True, eq=False)
class Path:
    """Joint waypoints joined by straight edges in joint space."""

    waypoints: Array
    """(n, dof) rad, n >= 1; consecutive waypoints differ."""

    @property
    def length_rad(self) -> float:
        """Sum of the edges' Euclidean lengths."""
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint positions and velocities on a time grid, cubic in between; at rest before and after is not implied."""

    t_s: Array
    """(n,) increasing, in simulated time, n >= 2."""
    q: Array
    """(n, dof) rad."""
    qd: Array
    """(n, dof) rad/s."""

    @property
    def start_s(self) -> float:
        return float(self.t_s[0])

    @property
    def end_s(self) -> float:
        return float(self.t_s[-1])

    def sample(self, t_s: float) -> tuple[Array, Array]:
        """(q, qd) at ``t_s`` by cubic Hermite interpolation; outside the grid the nearest end, standing still."""
        if t_s <= self.t_s[0]:
            return self.q[0], (self.qd[0] if t_s == self.t_s[0] else np.zeros_like(self.qd[0]))
        if t_s >= self.t_s[-1]:
            return self.q[-1], np.zeros_like(self.qd[-1])
        i = int(self.t_s.searchsorted(t_s, side="right")) - 1
        start_s, h = self._spans[i]
        u = (t_s - start_s) / h
        v0, c2, c3 = self._cubics[i]
        return self.q[i] + u * (v0 + u * (c2 + u * c3)), (v0 + u * (2.0 * c2 + u * 3.0 * c3)) / h

    @cached_property
    def _spans(self) -> list[tuple[float, float]]:
        """Start and length of each of the n - 1 pieces."""
        return list(zip(self.t_s[:-1].tolist(), np.diff(self.t_s).tolist(), strict=True))

    @cached_property
    def _cubics(self) -> Array:
        """(n - 1, 3, dof) what u, u^2 and u^3 are multiplied by in each piece, u going from 0 to 1."""
        h = np.diff(self.t_s)[:, None]
        v0, v1, delta = self.qd[:-1] * h, self.qd[1:] * h, np.diff(self.q, axis=0)
        return np.stack([v0, 3.0 * delta - 2.0 * v0 - v1, v0 + v1 - 2.0 * delta], axis=1)

    def shifted(self, by_s: float) -> Trajectory:
        """The same motion, ``by_s`` later."""
        return Trajectory(self.t_s + by_s, self.q, self.qd)

    @staticmethod
    def hold(q: Array, t_s: float) -> Trajectory:
        """Standing still at ``q`` from ``t_s`` on."""
        return Trajectory(np.array([t_s, t_s + 1e-3]), np.stack([q, q]), np.zeros((2, q.size)))
