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
HORIZONS_S = np.concatenate([np.linspace(0.0, 2.0, 9), [3.0, 4.0, 6.0, 8.0, 10.0, 12.0]])
"""For which the network answers: so far ahead looks an arm that meets the object in 8 s, and then goes in and lifts."""
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

    def reach_m(self, spread: Array) -> Array:
        """(b, horizons) metres that positions may be off by, of their logs in units of the answer; never less further
        ahead."""
        return np.maximum.accumulate(np.exp(spread) * self.scale[..., 0], axis=1)


def normalised(age_s: Array, states: Array, seen: Bools) -> Windows:
    """Windows of observations ``age_s`` (b, n) before the newest, where ``seen``; ``states`` are (b, n, 4).

    The newest comes first, at age 0, and is seen; what is older than ``WINDOW_S`` counts as unseen.
    """
    newest = states[:, :1]
    count, tau, mean = _binned(age_s, states - newest, seen)
    weight = (count * np.exp(tau[..., 0] / MEMORY_S))[..., None]
    weight /= weight.sum(axis=1, keepdims=True)
    by_weight = weight.transpose(0, 2, 1)
    mean_tau, middle = by_weight @ tau, by_weight @ mean
    since, off = tau - mean_tau, mean - middle
    spread = by_weight @ since**2
    slope = (weight * since).transpose(0, 2, 1) @ off / np.maximum(spread, 1e-12)
    off = (off - slope * since) * (count > 0.0)[..., None]
    turn, size = _headed(slope[:, 0]), _size(off, count)
    duration = np.sqrt(12.0 * np.maximum(spread, 1e-4))

    tokens = np.empty((*count.shape, FEATURES), dtype=np.float32)
    tokens[..., :4] = (off @ turn) / np.maximum(size, 1e-12)
    tokens[..., 4] = tau[..., 0] / 2.0
    tokens[..., 5] = np.log2(np.maximum(count, 1.0)) / 2.0
    tokens[..., 6:] = _facts(slope[:, 0], size[:, 0], duration[:, 0, 0])[:, None]
    lengths = (count > 0.0).sum(axis=1)
    if (lengths < count.shape[1]).any():
        order = np.argsort(count == 0.0, axis=1, kind="stable")
        tokens = np.take_along_axis(tokens, order[..., None], axis=1)
    line = np.concatenate([newest + middle - slope * mean_tau, slope], axis=1)
    return Windows(tokens, lengths, line, turn, size * (1.0 + HORIZONS_S[:, None] / duration) ** 2)


def _binned(age_s: Array, states: Array, seen: Bools) -> tuple[Array, Array, Array]:
    """Of each bin, oldest first: how many are in it (b, bins), their mean time (b, bins, 1) and state (b, bins, 4)."""
    bins = len(BINS_S) - 1 - np.searchsorted(BINS_S, age_s - 1e-9)
    member = ((bins[:, None] == np.arange(len(BINS_S))[:, None]) & seen[:, None]).astype(np.float64)
    count = member.sum(axis=2)
    member /= np.maximum(count, 1.0)[..., None]
    return count, member @ -age_s[..., None], member @ states


def _size(off: Array, count: Array) -> Array:
    """(b, 1, 4) root mean square distance from the line, of the position as one and of the yaw."""
    square = (count[:, None] @ off**2) / count.sum(axis=1)[:, None, None]
    square[..., :3] = square[..., :3].sum(axis=2, keepdims=True)
    return np.sqrt(square)


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


def _facts(slope: Array, size: Array, duration: Array) -> Array:
    """(b, 6) what the shape does not tell: absolute sizes, speed, climb, turning, and time covered."""
    speed = np.sqrt((slope[:, :3] ** 2).sum(axis=1))
    facts = np.empty((len(slope), 6))
    facts[:, 0] = np.log10(size[:, 0] / 1e-3 + 1e-3)
    facts[:, 1] = np.log10(speed / 1e-2 + 1e-2)
    facts[:, 2] = slope[:, 2] / (speed + 1e-4)
    facts[:, 3] = np.log10(size[:, 3] / 1e-2 + 1e-3)
    facts[:, 4] = np.tanh(5.0 * slope[:, 3])
    facts[:, 5] = duration / 2.0 - 1.0
    return facts
