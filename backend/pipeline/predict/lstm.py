"""The paper's learned predictor (section IV-A), run in numpy: LSTM, two Dense, Dense(horizons x 4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from backend.knowledge.predictor import PredictorWeights, load_weights
from backend.methods.method import Kalman
from backend.pipeline.predict.heading import measured, poses, tilt_of
from backend.pipeline.predict.kalman import KalmanPredictor
from backend.pipeline.predict.window import FEATURES, HORIZONS_S, MIN_BINS, WINDOW_S, normalised
from backend.pipeline.values import Observation, Prediction
from backend.pose import Array

Floats = NDArray[np.float32]
ROWS = 256
BENDS = CubicSpline(HORIZONS_S, np.eye(len(HORIZONS_S)), bc_type="natural")(HORIZONS_S, 2)
"""(horizons, horizons) a smooth curve's second derivatives at ``HORIZONS_S``, of each value there."""


class Forward:
    """The network's forward pass over one sequence."""

    def __init__(self, weights: PredictorWeights) -> None:
        hidden = weights.lstm_hidden.shape[1]
        i, f, g, o = np.arange(4 * hidden).reshape(4, hidden)
        order = np.concatenate([i, f, o, g])
        halved = np.where(np.arange(4 * hidden) < 3 * hidden, 0.5, 1.0).astype(np.float32)[:, None]
        self._hidden = hidden
        self._in = np.ascontiguousarray((weights.lstm_in[order] * halved).T)
        self._bias = weights.lstm_bias[order] * halved[:, 0]
        self._recurrent = np.ascontiguousarray(weights.lstm_hidden[order] * halved)
        self._dense = weights.dense

    def __call__(self, tokens: Floats) -> Array:
        """(horizons, 4) answer to tokens (n, FEATURES).

        The sigmoids are taken as 1/2 + 1/2 tanh(x / 2), so that one call serves all four gates.
        """
        n = self._hidden
        h, c = np.zeros(n, dtype=np.float32), np.zeros(n, dtype=np.float32)
        gates = np.zeros(4 * n, dtype=np.float32)
        sigmoids = gates[: 3 * n]
        entered, kept, shown, new = gates.reshape(4, n)
        for step, drive in enumerate(tokens @ self._in + self._bias):
            if step:
                np.dot(self._recurrent, h, out=gates)
            np.add(gates, drive, out=gates)
            np.tanh(gates, out=gates)
            np.multiply(sigmoids, 0.5, out=sigmoids)
            np.add(sigmoids, 0.5, out=sigmoids)
            np.multiply(c, kept, out=c)
            np.multiply(entered, new, out=new)
            np.add(c, new, out=c)
            np.tanh(c, out=h)
            np.multiply(h, shown, out=h)
        for weight, bias in self._dense[:-1]:
            h = np.maximum(weight @ h + bias, 0.0)
        weight, bias = self._dense[-1]
        return (weight @ h + bias).reshape(-1, 4).astype(np.float64)


class LstmPredictor:
    """Keeps the observations of the last ``WINDOW_S``; with too few of them for the network, a Kalman filter answers.

    Between the network's horizons the states are on a smooth curve: an arm that follows it must not be asked to jump in
    speed. Beyond, they go straight on.

    Raises ``MissingResourceError`` or ``InvalidInputError`` when the weights are not there or not whole.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._network = Forward(load_weights(FEATURES, 4 * len(HORIZONS_S), path))
        self._rows = np.empty((ROWS, 5))
        self._begin = self._end = 0
        self._tilt = np.eye(3)
        self._at_first = KalmanPredictor(Kalman())
        self._known: Array | None = None
        """The network's answer to what is kept now; None until somebody asks."""

    def observe(self, observation: Observation) -> None:
        if observation.T_world_object is None:
            return
        self._at_first.observe(observation)
        self._known = None
        previous = float(self._rows[self._end - 1, 4]) if self._end else None
        if self._end == len(self._rows):
            self._make_room()
        self._rows[self._end] = observation.t_s, *measured(observation, previous)
        self._end += 1
        while self._rows[self._begin, 0] < observation.t_s - WINDOW_S - 1e-9:
            self._begin += 1
        self._tilt = tilt_of(observation.T_world_object)

    def predict(self, t_s: Array) -> Prediction | None:
        if self._end == 0:
            return None
        if self._known is None:
            self._known = self._answer()
        known = self._known
        if known is None:
            return self._at_first.predict(t_s)
        ahead = between(known, t_s - self._rows[self._end - 1, 0])
        velocity = (known[1, :3] - known[0, :3]) / (HORIZONS_S[1] - HORIZONS_S[0])
        return Prediction(t_s, poses(ahead, self._tilt), np.zeros(len(t_s)), velocity)

    def _answer(self) -> Array | None:
        """(horizons, 4) states at ``HORIZONS_S`` after the newest observation; None of too few observations."""
        kept = self._rows[self._begin : self._end]
        newest_first = kept[None, ::-1]
        seen = np.ones((1, len(kept)), dtype=np.bool_)
        windows = normalised(kept[-1, 0] - newest_first[..., 0], newest_first[..., 1:], seen)
        length = int(windows.lengths[0])
        if length < MIN_BINS:
            return None
        answer = self._network(windows.tokens[0, :length]) if windows.scale.any() else np.zeros((len(HORIZONS_S), 4))
        return windows.states(answer[None])[0]

    def _make_room(self) -> None:
        """Move what is kept to the front; into a larger block when it fills most of this one."""
        kept = self._rows[self._begin : self._end].copy()
        if 2 * len(kept) > len(self._rows):
            self._rows = np.empty((2 * len(self._rows), 5))
        self._rows[: len(kept)] = kept
        self._begin, self._end = 0, len(kept)


def between(known: Array, ahead_s: Array) -> Array:
    """(n, 4) states ``ahead_s`` (n,) after the newest observation, from those ``known`` at ``HORIZONS_S``.

    They are on the natural cubic spline; before the first and after the last known one it goes straight on.
    """
    inside = np.clip(ahead_s, HORIZONS_S[0], HORIZONS_S[-1])
    left = np.clip(np.searchsorted(HORIZONS_S, inside) - 1, 0, len(HORIZONS_S) - 2)
    width = (HORIZONS_S[left + 1] - HORIZONS_S[left])[:, None]
    done = (inside - HORIZONS_S[left])[:, None] / width
    rest = 1.0 - done
    bends = BENDS @ known
    at_left, at_right = (bends[k] * (width**2 / 6.0) for k in (left, left + 1))
    states = rest * known[left] + done * known[left + 1] + (rest**3 - rest) * at_left + (done**3 - done) * at_right
    slope = (known[left + 1] - known[left] - (3 * rest**2 - 1) * at_left + (3 * done**2 - 1) * at_right) / width
    return states + (ahead_s - inside)[:, None] * slope
