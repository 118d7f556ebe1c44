"""No prediction: the object stays where it was last seen."""

import numpy as np

from backend.pipeline.values import Observation, Prediction
from backend.pose import Array, Pose


class LastPosePredictor:
    """Remembers the newest detection."""

    def __init__(self) -> None:
        self._pose: Pose | None = None

    def observe(self, observation: Observation) -> None:
        self._pose = observation.T_world_object or self._pose

    def predict(self, t_s: Array) -> Prediction | None:
        if self._pose is None:
            return None
        n = len(t_s)
        return Prediction(t_s, np.repeat(self._pose.matrix[None], n, axis=0), np.zeros(n), np.zeros(3))
