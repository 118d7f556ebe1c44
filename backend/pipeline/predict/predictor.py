"""What every predictor can do: take observations in, say where the object will be."""

from typing import Protocol

from backend.pipeline.values import Observation, Prediction
from backend.pose import Array


class Predictor(Protocol):
    """Holds what it needs of the observations so far; never sees the world."""

    def observe(self, observation: Observation) -> None:
        """Take in one observation, in order of time."""
        ...

    def predict(self, t_s: Array) -> Prediction | None:
        """Poses at the simulated times ``t_s`` (n,); None before the first detection."""
        ...
