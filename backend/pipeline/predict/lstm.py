"""The paper's learned predictor (section IV-A), run in numpy: LSTM, two Dense, Dense(horizons x 4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from backend.knowledge.predictor import Floats, Layer, PredictorWeights, load_weights
from backend.methods.method import Kalman
from backend.pipeline.predict.heading import measured, poses, tilt_of
from backend.pipeline.predict.kalman import KalmanPredictor
from backend.pipeline.predict.window import FEATURES, HORIZONS_S, MIN_BINS, WINDOW_S, normalised
from backend.pipeline.values import Observation, Prediction
from backend.pose import Array

ROWS = 256
PIECE_FROM_S = HORIZONS_S[[0, *range(len(HORIZONS_S))]]
"""(pieces,) of the curve through the network's answers: before the first horizon, between two, and after the last."""


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
        self._spread = weights.spread

    def __call__(self, tokens: Floats) -> tuple[Array, Array]:
        """The answer (horizons, 4) to tokens (n, FEATURES), and the log of how far off it may be (horizons,).

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
        answer, spread = _through(self._dense, h), _through(self._spread, h)
        return answer.reshape(-1, 4).astype(np.float64), spread.astype(np.float64)


def _through(layers: tuple[Layer, ...], x: Floats) -> Floats:
    """What fully connected layers make of ``x``, with a ReLU after each but the last."""
    for weight, bias in layers[:-1]:
        x = np.maximum(weight @ x + bias, 0.0)
    weight, bias = layers[-1]
    return weight @ x + bias


class LstmPredictor:
    """Keeps the observations of the last ``WINDOW_S``; with too few of them for the network, a Kalman filter answers.

    Between the network's horizons the states are on a smooth curve: an arm that follows it must not be asked to jump in
    speed. Beyond, they go straight on. Two standard deviations are the distance that one position in twenty is learnt
    to be off by; beyond the last horizon they grow no more.

    Raises ``MissingResourceError`` or ``InvalidInputError`` when the weights are not there or not whole.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._network = Forward(load_weights(FEATURES, len(HORIZONS_S), path))
        self._rows = np.empty((ROWS, 5))
        self._begin = self._end = 0
        self._tilt = np.eye(3)
        self._at_first = KalmanPredictor(Kalman())
        self._known: tuple[Array, Array] | None = None
        """The curve through the network's answers to what is kept now, and their standard deviations (horizons,) in
        metres; None until somebody asks."""

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
            answer = self._answer()
            if answer is None:
                return self._at_first.predict(t_s)
            self._known = curve(answer[0]), answer[1]
        way, std_m = self._known
        ahead_s = t_s - self._rows[self._end - 1, 0]
        stds_m = np.interp(ahead_s, HORIZONS_S, std_m)
        return Prediction(t_s, poses(along(way, ahead_s), self._tilt), stds_m, way[0, 1, :3])

    def _answer(self) -> tuple[Array, Array] | None:
        """States (horizons, 4) at ``HORIZONS_S`` after the newest observation and their standard deviations
        (horizons,) in metres; None of too few observations."""
        kept = self._rows[self._begin : self._end]
        newest_first = kept[None, ::-1]
        seen = np.ones((1, len(kept)), dtype=np.bool_)
        windows = normalised(kept[-1, 0] - newest_first[..., 0], newest_first[..., 1:], seen)
        length = int(windows.lengths[0])
        if length < MIN_BINS:
            return None
        if not windows.scale.any():
            return windows.states(np.zeros((1, len(HORIZONS_S), 4)))[0], np.zeros(len(HORIZONS_S))
        answer, spread = self._network(windows.tokens[0, :length])
        return windows.states(answer[None])[0], 0.5 * windows.reach_m(spread[None])[0]

    def _make_room(self) -> None:
        """Move what is kept to the front; into a larger block when it fills most of this one."""
        kept = self._rows[self._begin : self._end].copy()
        if 2 * len(kept) > len(self._rows):
            self._rows = np.empty((2 * len(self._rows), 5))
        self._rows[: len(kept)] = kept
        self._begin, self._end = 0, len(kept)


def _pieces() -> Array:
    """(pieces, 4, horizons) powers 0 to 3 of each piece, per value at ``HORIZONS_S``; the ends go straight on."""
    spline = CubicSpline(HORIZONS_S, np.eye(len(HORIZONS_S)), bc_type="natural")
    pieces = np.zeros((len(PIECE_FROM_S), 4, len(HORIZONS_S)))
    pieces[1:-1] = spline.c[::-1].transpose(1, 0, 2)
    for end in (0, -1):
        pieces[end, :2] = spline(HORIZONS_S[end]), spline(HORIZONS_S[end], 1)
    return pieces


PIECES = _pieces()


def curve(known: Array) -> Array:
    """(pieces, 4, 4) powers 0 to 3 of each piece of the smooth curve through states ``known`` at ``HORIZONS_S``."""
    return (PIECES.reshape(-1, len(HORIZONS_S)) @ known).reshape(-1, 4, known.shape[1])


def along(powers: Array, ahead_s: Array) -> Array:
    """(n, 4) states ``ahead_s`` (n,) after the newest observation, on a ``curve`` (pieces, 4, 4)."""
    piece = np.searchsorted(HORIZONS_S, ahead_s)
    powers, since_s = powers[piece], (ahead_s - PIECE_FROM_S[piece])[:, None]
    return ((powers[:, 3] * since_s + powers[:, 2]) * since_s + powers[:, 1]) * since_s + powers[:, 0]
