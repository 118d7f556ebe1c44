"""Kalman filter on position and yaw with white-noise acceleration (Bar-Shalom et al. 2001, section 6.2.2)."""

import numpy as np

from backend.methods.method import Kalman
from backend.pipeline.predict.heading import measured, poses, tilt_of
from backend.pipeline.values import Observation, Prediction
from backend.pose import Array

START_SPEED_STD_MPS = 0.2


class KalmanPredictor:
    """Four independent position-velocity filters: x, y, z and yaw share one gain, since they share their noise."""

    def __init__(self, config: Kalman) -> None:
        self._spectral = config.acceleration_std_mps2**2
        self._noise = config.measurement_std_m**2
        self._t_s = 0.0
        self._state: Array | None = None
        self._covariance = np.zeros((2, 2))
        self._tilt = np.eye(3)

    def observe(self, observation: Observation) -> None:
        if observation.T_world_object is None:
            return
        self._tilt = tilt_of(observation.T_world_object)
        if self._state is None:
            self._state = np.stack([measured(observation, None), np.zeros(4)])
            self._covariance = np.diag([self._noise, START_SPEED_STD_MPS**2])
            self._t_s = observation.t_s
            return
        state, covariance = self._propagated(self._state, observation.t_s - self._t_s)
        gain = covariance[:, 0] / (covariance[0, 0] + self._noise)
        innovation = measured(observation, float(state[0, 3])) - state[0]
        self._state = state + np.outer(gain, innovation)
        self._covariance = covariance - np.outer(gain, covariance[0])
        self._t_s = observation.t_s

    def predict(self, t_s: Array) -> Prediction | None:
        if self._state is None:
            return None
        ahead = t_s - self._t_s
        states = self._state[0] + ahead[:, None] * self._state[1]
        dt = np.maximum(ahead, 0.0)
        (p, c), (_, v) = self._covariance.tolist()
        variance = p + dt * (2.0 * c + dt * (v + dt * self._spectral / 3.0))
        return Prediction(t_s, poses(states, self._tilt), np.sqrt(variance), self._state[1, :3])

    def _propagated(self, state: Array, dt_s: float) -> tuple[Array, Array]:
        """State (2, 4) and covariance (2, 2) after ``dt_s`` without a measurement."""
        F = np.array([[1.0, dt_s], [0.0, 1.0]])
        Q = self._spectral * np.array([[dt_s**3 / 3, dt_s**2 / 2], [dt_s**2 / 2, dt_s]])
        return F @ state, F @ self._covariance @ F.T + Q
