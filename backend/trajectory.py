"""Path (waypoints, no time) and Trajectory (timed), in joint space."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backend.pose import Array

SAME_MOMENT_S = 1e-9
"""Times that differ by less are one moment: a clock that adds up steps and one that multiplies them round otherwise."""


@dataclass(frozen=True, eq=False)
class Path:
    """Joint waypoints joined by straight edges in joint space."""

    waypoints: Array
    """(n, dof) rad, n >= 1; consecutive waypoints differ."""

    @property
    def length_rad(self) -> float:
        """Sum of the edges' Euclidean lengths."""
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())

    def remaining_from(self, q: Array) -> Path:
        """What is left of it for an arm at ``q`` (dof,): that posture, then the waypoints still ahead."""
        edges = np.diff(self.waypoints, axis=0)
        lengths = np.maximum((edges**2).sum(axis=1), 1e-12)
        along = np.clip(((q - self.waypoints[:-1]) * edges).sum(axis=1) / lengths, 0.0, 1.0)
        gaps = np.linalg.norm(self.waypoints[:-1] + along[:, None] * edges - q, axis=1)
        nearest = len(gaps) - 1 - int(np.argmin(gaps[::-1])) if len(gaps) else 0
        return Path(np.vstack([q, self.waypoints[nearest + 1 :]]))


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
        q, qd = self.sample_plain(t_s)
        return np.array(q), np.array(qd)

    def sample_plain(self, t_s: float) -> tuple[list[float], list[float]]:
        """The same as plain numbers, which is quicker where they are not calculated with."""
        times = self._times
        if t_s <= times[0]:
            return self.q[0].tolist(), self.qd[0].tolist() if t_s > times[0] - SAME_MOMENT_S else self._still
        if t_s >= times[-1]:
            return self._end, self._still
        i = bisect_right(times, t_s) - 1
        h = times[i + 1] - times[i]
        u = (t_s - times[i]) / h
        u3 = u * 3.0
        joints = self._piece(i)
        q = [q0 + u * (v0 + u * (c2 + u * c3)) for q0, v0, c2, c3 in joints]
        qd = [(v0 + u * (2.0 * c2 + u3 * c3)) / h for _, v0, c2, c3 in joints]
        return q, qd

    def positions(self, t_s: Array) -> Array:
        """(m, dof) q at times (m,), as ``sample`` has it."""
        grid = self.t_s
        piece = np.clip(np.searchsorted(grid, t_s, side="right") - 1, 0, len(grid) - 2)
        h = (grid[piece + 1] - grid[piece])[:, None]
        u = (t_s - grid[piece])[:, None] / h
        q0, v0, v1 = self.q[piece], self.qd[piece] * h, self.qd[piece + 1] * h
        delta = self.q[piece + 1] - q0
        inside = q0 + u * (v0 + u * (3.0 * delta - 2.0 * v0 - v1 + u * (v0 + v1 - 2.0 * delta)))
        return np.where(t_s[:, None] <= grid[0], self.q[0], np.where(t_s[:, None] >= grid[-1], self.q[-1], inside))

    def peaks(self, from_s: float = -np.inf, until_s: float = np.inf) -> tuple[Array, Array]:
        """(dof,) largest |qd| and |qdd| of every joint, exactly, over the pieces that begin in a span of time."""
        chosen = (self.t_s[:-1] >= from_s - SAME_MOMENT_S) & (self.t_s[:-1] < until_s - SAME_MOMENT_S)
        h = np.diff(self.t_s)[chosen, None]
        v0, v1 = self.qd[:-1][chosen], self.qd[1:][chosen]
        rise = np.diff(self.q, axis=0)[chosen] / h
        a0, a1 = (6.0 * rise - 4.0 * v0 - 2.0 * v1) / h, (2.0 * v0 + 4.0 * v1 - 6.0 * rise) / h
        turns = (a0 * a1 < 0.0) & (a0 != a1)
        share = np.where(turns, a0 / np.where(turns, a0 - a1, 1.0), 0.0)
        inside = v0 + h * share * (a0 + 0.5 * share * (a1 - a0))
        velocity = np.abs(np.concatenate([v0, v1, inside])).max(axis=0, initial=0.0)
        return velocity, np.abs(np.concatenate([a0, a1])).max(axis=0, initial=0.0)

    @cached_property
    def _end(self) -> list[float]:
        return self.q[-1].tolist()

    @cached_property
    def _still(self) -> list[float]:
        return [0.0] * self.q.shape[1]

    @cached_property
    def _times(self) -> list[float]:
        """The grid as plain numbers: this is asked at every step, and Python is quicker than numpy on so few."""
        return self.t_s.tolist()

    def _piece(self, i: int) -> list[tuple[float, float, float, float]]:
        """What 1, u, u^2 and u^3 are multiplied by in piece i, for every joint.

        Most motions are replaced before most of their pieces are come to.
        """
        kept = self._kept.get(i)
        if kept is None:
            h = self._times[i + 1] - self._times[i]
            rows = (self.q[i], self.q[i + 1], self.qd[i], self.qd[i + 1])
            kept = self._kept[i] = [
                (q0, v0 * h, 3.0 * (q1 - q0) - 2.0 * (v0 * h) - v1 * h, v0 * h + v1 * h - 2.0 * (q1 - q0))
                for q0, q1, v0, v1 in zip(*(row.tolist() for row in rows), strict=True)
            ]
        return kept

    @cached_property
    def _kept(self) -> dict[int, list[tuple[float, float, float, float]]]:
        return {}

    def shifted(self, by_s: float) -> Trajectory:
        """The same motion, ``by_s`` later."""
        return Trajectory(self.t_s + by_s, self.q, self.qd)

    @staticmethod
    def hold(q: Array, t_s: float) -> Trajectory:
        """Standing still at ``q`` from ``t_s`` on."""
        return Trajectory(np.array([t_s, t_s + 1e-3]), np.stack([q, q]), np.zeros((2, q.size)))
