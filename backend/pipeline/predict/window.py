"""The newest observations as the learned predictor is shown them: normalised by translation, velocity and heading.

The paper subtracts the first point of a sequence (section IV-A). Here the straight line through the sequence is
subtracted as well, what is left is turned to the line's heading and divided by its own size, and the network's
answer is carried back the same way. A prediction therefore moves, turns and drifts along with what it was made from,
and on a perfectly straight, even motion it is the line itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.pose import Array

Bools = NDArray[np.bool_]

BINS_S = np.cumsum([0.1, 0.1, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0])
"""Ages at which the bins end, newest first: fine where the motion is fresh, coarse where averaging helps."""
WINDOW_S = float(BINS_S[-1])
HORIZONS_S = np.linspace(0.0, 2.0, 9)
"""For which the network answers; in between it is interpolated."""
MEMORY_S = 1.5
"""Weights of the straight line fall by e over this age."""
MIN_BINS = 4
"""With fewer bins than this the line stands alone."""
FEATURES = 12


@dataclass(frozen=True, eq=False)
class Windows:
    """b normalised sequences; arrays of metres and radians have the columns x, y, z, yaw."""

    tokens: NDArray[np.float32]
    """(b, bins, FEATURES), oldest first; rows from ``lengths`` on are to be left alone."""
    lengths: NDArray[np.int64]
    """(b,) bins that hold an observation."""
    line: Array
    """(b, 2, 4) the straight line: value at the newest observation, and slope per second."""
    turn: Array
    """(b, 4, 4) rotation about z, from the heading's frame to the world's."""
    scale: Array
    """(b, horizons, 4) what one unit of the network's answer is worth; zero on a perfect line."""

    def states(self, answer: Array) -> Array:
        """(b, horizons, 4) states at ``HORIZONS_S`` from the network's answer of the same shape."""
        ahead = self.line[:, None, 0] + HORIZONS_S[:, None] * self.line[:, None, 1]
        return ahead + self.residual(answer)

    def residual(self, answer: Array) -> Array:
        """(b, horizons, 4) metres and radians off the line."""
        return (answer * self.scale) @ self.turn.transpose(0, 2, 1)


def normalised(age_s: Array, states: Array, seen: Bools) -> Windows:
    """Windows of observations ``age_s`` (b, n) before the newest, where ``seen``; ``states`` are (b, n, 4).

    At least one observation of each sequence must be seen; what is older than ``WINDOW_S`` counts as unseen.
    """
    member = (np.searchsorted(BINS_S, age_s - 1e-9)[..., None] == np.arange(len(BINS_S))[::-1]) & seen[..., None]
    share = member.astype(np.float64).transpose(0, 2, 1)
    count = share.sum(axis=2)
    newest = np.take_along_axis(states, np.where(seen, age_s, np.inf).argmin(axis=1)[:, None, None], axis=1)
    total = np.maximum(count, 1.0)[..., None]
    tau = -(share @ age_s[..., None]) / total
    mean = (share @ (states - newest)) / total

    weight = (count * np.exp(tau[..., 0] / MEMORY_S))[..., None]
    weight /= weight.sum(axis=1, keepdims=True)
    mean_tau, middle = (weight * tau).sum(axis=1, keepdims=True), (weight * mean).sum(axis=1, keepdims=True)
    spread = (weight * (tau - mean_tau) ** 2).sum(axis=1, keepdims=True)
    slope = (weight * (tau - mean_tau) * (mean - middle)).sum(axis=1, keepdims=True) / np.maximum(spread, 1e-12)
    off = (mean - middle - slope * (tau - mean_tau)) * (count > 0)[..., None]
    turn = _headed(slope[:, 0])
    size = _size(off, count)
    duration = np.sqrt(12.0 * np.maximum(spread, 1e-4))

    shape = (off @ turn) / np.maximum(size, 1e-12)
    tokens = np.concatenate(
        [shape, tau / 2.0, np.log2(total) / 2.0, _facts(slope, size, duration, len(BINS_S))], axis=2
    )
    order = np.argsort(count == 0, axis=1, kind="stable")
    return Windows(
        tokens=np.take_along_axis(tokens, order[..., None], axis=1).astype(np.float32),
        lengths=(count > 0).sum(axis=1),
        line=np.concatenate([newest + middle - slope * mean_tau, slope], axis=1),
        turn=turn,
        scale=size * (1.0 + HORIZONS_S[:, None] / duration) ** 2,
    )


def _size(off: Array, count: Array) -> Array:
    """(b, 1, 4) root mean square distance from the line, of the position as one and of the yaw."""
    square = (count[..., None] * off**2).sum(axis=1) / count.sum(axis=1)[:, None]
    position = np.sqrt(square[:, :3].sum(axis=1))
    return np.stack([position, position, position, np.sqrt(square[:, 3])], axis=1)[:, None]


def _headed(slope: Array) -> Array:
    """(b, 4, 4) turns of the x axis to the level direction of ``slope`` (b, 4); none where there is none."""
    level = np.hypot(slope[:, 0], slope[:, 1])
    still = level < 1e-12
    cos = np.where(still, 1.0, slope[:, 0] / np.where(still, 1.0, level))
    sin = np.where(still, 0.0, slope[:, 1] / np.where(still, 1.0, level))
    turn = np.zeros((len(slope), 4, 4))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = cos, -sin, sin, cos
    turn[:, 2, 2] = turn[:, 3, 3] = 1.0
    return turn


def _facts(slope: Array, size: Array, duration: Array, n: int) -> Array:
    """(b, n, 6) what the shape does not tell: absolute sizes, speed, climb, turning, and time covered."""
    speed = np.sqrt((slope[..., :3] ** 2).sum(axis=2, keepdims=True))
    facts = [
        np.log10(size[..., :1] / 1e-3 + 1e-3),
        np.log10(speed / 1e-2 + 1e-2),
        slope[..., 2:3] / (speed + 1e-4),
        np.log10(size[..., 3:] / 1e-2 + 1e-3),
        np.tanh(5.0 * slope[..., 3:]),
        duration / 2.0 - 1.0,
    ]
    return np.repeat(np.concatenate(facts, axis=2), n, axis=1)
