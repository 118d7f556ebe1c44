"""The true motion; for tests and upper bounds only. The one predictor that is handed the future."""

from collections.abc import Callable

import numpy as np

from backend.pipeline.values import Observation, Prediction
from backend.pose import Array, Pose

TruePose = Callable[[float], Pose]
"""T_world_object at a simulated time, as it will really be if the belt is left alone."""


class OraclePredictor:
    """Ignores what it observes."""

    def __init__(self, truth: TruePose) -> None:
        self._truth = truth
        self._now_s = 0.0

    def observe(self, observation: Observation) -> None:
        self._now_s = observation.t_s

    def predict(self, t_s: Array) -> Prediction | None:
        matrices = np.stack([self._truth(float(t)).matrix for t in t_s])
        step = 1e-3
        velocity = (self._truth(self._now_s + step).xyz_m - self._truth(self._now_s).xyz_m) / step
        return Prediction(t_s, matrices, np.zeros(len(t_s)), velocity)
