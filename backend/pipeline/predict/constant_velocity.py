"""Straight on, with the velocity of a least-squares line through the newest observations."""

from collections import deque

import numpy as np

from backend.methods.method import ConstantVelocity
from backend.pipeline.predict.heading import measured, poses, tilt_of
from backend.pipeline.values import Observation, Prediction
from backend.pose import Array


class ConstantVelocityPredictor:
    """Keeps the observations of the last ``window_s``."""

    def __init__(self, config: ConstantVelocity) -> None:
        self._window_s = config.window_s
        self._times: deque[float] = deque()
        self._states: deque[Array] = deque()
        self._tilt = np.eye(3)

    def observe(self, observation: Observation) -> None:
        if observation.T_world_object is None:
            return
        previous = float(self._states[-1][3]) if self._states else None
        self._states.append(measured(observation, previous))
        self._times.append(observation.t_s)
        self._tilt = tilt_of(observation.T_world_object)
        while len(self._times) > 2 and self._times[-1] - self._times[0] > self._window_s:
            self._times.popleft()
            self._states.popleft()

    def predict(self, t_s: Array) -> Prediction | None:
        if not self._states:
            return None
        times, states = np.array(self._times), np.array(self._states)
        mean_t, mean = times.mean(), states.mean(axis=0)
        spread = ((times - mean_t) ** 2).sum()
        slope = ((times - mean_t) @ (states - mean)) / spread if spread > 0.0 else np.zeros(4)
        ahead = mean + np.outer(t_s - mean_t, slope)
        return Prediction(t_s, poses(ahead, self._tilt), np.zeros(len(t_s)), slope[:3])
