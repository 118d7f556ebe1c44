"""Curve: a smooth joint-space curve of cubic pieces, and how a path with corners becomes one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backend.pose import Array

STRAIGHT = 1.0 - 1e-9
"""Cosine between two edges beyond which they are one."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Pieces ``q(u) = c0 + c1 u + c2 u^2 + c3 u^3`` for u in [0, length]; q and q' are continuous."""

    coefficients: Array
    """(n, 4, dof)."""
    lengths: Array
    """(n,) of each piece's parameter; radians along straight pieces."""

    @property
    def length(self) -> float:
        return float(self.lengths.sum())

    @cached_property
    def marks(self) -> Array:
        """(n + 1,) parameter at which each piece begins, and the end."""
        return np.concatenate([[0.0], np.cumsum(self.lengths)])

    def at(self, s: Array, order: int = 0) -> Array:
        """(m, dof) the curve, or its first or second derivative, at parameters (m,)."""
        piece = np.clip(np.searchsorted(self.marks, s, side="right") - 1, 0, len(self.lengths) - 1)
        return _evaluate(self.coefficients[piece], s - self.marks[piece], order)

    def from_mark(self, s: float) -> Curve:
        """What is left of the curve after parameter ``s``."""
        piece = int(np.clip(np.searchsorted(self.marks, s, side="right") - 1, 0, len(self.lengths) - 1))
        u = s - self.marks[piece]
        c0, c1, c2, c3 = self.coefficients[piece]
        first = np.array([c0 + u * (c1 + u * (c2 + u * c3)), c1 + u * (2 * c2 + 3 * u * c3), c2 + 3 * u * c3, c3])
        return Curve(
            np.concatenate([first[None], self.coefficients[piece + 1 :]]),
            np.concatenate([[self.lengths[piece] - u], self.lengths[piece + 1 :]]),
        )

    def after(self, first: Curve) -> Curve:
        """``first``, then this curve."""
        return Curve(
            np.concatenate([first.coefficients, self.coefficients]),
            np.concatenate([first.lengths, self.lengths]),
        )


def rounded(waypoints: Array, deviation_rad: float) -> Curve:
    """The path (n >= 2, dof) with parabolas at its corners that stay within ``deviation_rad`` of them."""
    edges = np.diff(waypoints, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    directions = edges / lengths[:, None]
    cut = np.zeros(len(waypoints))
    for i in range(1, len(waypoints) - 1):
        turn = float(np.linalg.norm(directions[i] - directions[i - 1]))
        if directions[i] @ directions[i - 1] < STRAIGHT:
            cut[i] = min(4.0 * deviation_rad / turn, 0.499 * lengths[i - 1], 0.499 * lengths[i])
    pieces: list[Array] = []
    sizes: list[float] = []
    for i, direction in enumerate(directions):
        zero = np.zeros_like(direction)
        pieces.append(np.array([waypoints[i] + cut[i] * direction, direction, zero, zero]))
        sizes.append(float(lengths[i] - cut[i] - cut[i + 1]))
        if i + 1 < len(directions) and cut[i + 1] > 0.0:
            r = cut[i + 1]
            bend = (directions[i + 1] - direction) / (4.0 * r)
            pieces.append(np.array([waypoints[i + 1] - r * direction, direction, bend, zero]))
            sizes.append(2.0 * r)
    return Curve(np.array(pieces), np.array(sizes))


def hermite(q0: Array, slope0: Array, q1: Array, slope1: Array, length: float) -> Curve:
    """One cubic piece between two points with given derivatives."""
    delta = (q1 - q0) / length
    c2 = (3.0 * delta - 2.0 * slope0 - slope1) / length
    c3 = (slope0 + slope1 - 2.0 * delta) / length**2
    return Curve(np.array([[q0, slope0, c2, c3]]), np.array([length]))


def _evaluate(c: Array, u: Array, order: int) -> Array:
    u = u[:, None]
    if order == 0:
        return c[:, 0] + u * (c[:, 1] + u * (c[:, 2] + u * c[:, 3]))
    if order == 1:
        return c[:, 1] + u * (2.0 * c[:, 2] + 3.0 * u * c[:, 3])
    return 2.0 * c[:, 2] + 6.0 * u * c[:, 3]
