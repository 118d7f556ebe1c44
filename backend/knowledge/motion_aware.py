"""MotionAwareModel: how likely a grasp holds the object while it moves (section IV-C of the paper), run in numpy."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.knowledge.motion_features import (
    FEATURES,
    GRASP_FEATURES,
    grasp_features,
    motion_features,
)
from backend.knowledge.pairs import check_pair, pair_file
from backend.knowledge.shelf import Arrays, Label, read, write
from backend.pose import Array

Floats = NDArray[np.float32]
Layer = tuple[Floats, Floats]
FORMAT = 1
STILL_DIRECTIONS = 16
SPEED_STEP_MPS = 5e-4
DIRECTION_STEP_RAD = np.radians(1.0)
"""Motions that differ by less count as one in ``PreparedGrasps.about``."""


@dataclass(frozen=True, eq=False)
class MotionAwareModel:
    """Two hidden layers with ReLU and a logit, trained on simulated attempts of one hand on one object."""

    robot: str
    object: str
    backoff_m: float
    """Distance of the pregrasps it was trained with."""
    speeds_mps: tuple[float, float]
    """Slowest and fastest object it was trained with."""
    center: Floats
    """(FEATURES,) taken from the features before the first layer."""
    scale: Floats
    """(FEATURES,) that they are then divided by."""
    layers: tuple[Layer, Layer, Layer]
    """(weight (out, in), bias (out,)) each."""
    facts: dict[str, Any] = field(default_factory=dict[str, Any])
    """How it was made, and how good it is."""

    def quality(self, Ts_object_grasp: Array, speed_mps: float, direction_rad: float) -> Array:
        """(n,) probability that grasps (n, 4, 4) hold; see ``PreparedGrasps.quality``."""
        return self.over(Ts_object_grasp).quality(speed_mps, direction_rad)

    def over(self, Ts_object_grasp: Array) -> PreparedGrasps:
        """The model with all that depends on the grasps (n, 4, 4) alone worked out beforehand."""
        features = grasp_features(Ts_object_grasp, self.backoff_m)
        centered = (features - self.center[:GRASP_FEATURES]) / self.scale[:GRASP_FEATURES]
        weight, bias = self.layers[0]
        return PreparedGrasps(self, centered.astype(np.float32) @ weight[:, :GRASP_FEATURES].T + bias)

    def logits(self, Ts_object_grasp: Array, speed_mps: Array, direction_rad: Array) -> Array:
        """(n,) log odds of n grasps (n, 4, 4), each in a motion of its own."""
        return self.hidden_to_logits(self.over(Ts_object_grasp).base + self.motion_part(speed_mps, direction_rad))

    def motion_part(self, speed_mps: Array, direction_rad: Array) -> Floats:
        """(n, hidden) what motions (n,) add to the first layer; speeds beyond those trained with count as those."""
        features = motion_features(np.clip(speed_mps, *self.speeds_mps), direction_rad)
        centered = (features - self.center[GRASP_FEATURES:]) / self.scale[GRASP_FEATURES:]
        return centered.astype(np.float32) @ self.layers[0][0][:, GRASP_FEATURES:].T

    def hidden_to_logits(self, hidden: Floats) -> Array:
        """(n,) log odds of what the first layer gives (n, hidden), before its ReLU; ``hidden`` is written over."""
        np.maximum(hidden, 0.0, out=hidden)
        out: Floats = hidden @ self._into_second
        (_, bias), (last_weight, last_bias) = self.layers[1:]
        out += bias
        np.maximum(out, 0.0, out=out)
        return (out @ last_weight[0] + last_bias[0]).astype(np.float64)

    @cached_property
    def _into_second(self) -> Floats:
        """(hidden, hidden) weight of the second layer, laid out for the product that takes most of the time."""
        return np.ascontiguousarray(self.layers[1][0].T)


@dataclass(frozen=True, eq=False)
class PreparedGrasps:
    """Grasps of which only the motion is open."""

    model: MotionAwareModel
    base: Floats
    """(n, hidden) of the first layer, without the motion's part."""
    _known: dict[tuple[int, int], Array] = field(default_factory=dict[tuple[int, int], Array])

    def about(self, speed_mps: float, direction_rad: float) -> Array:
        """As ``quality``, of the motion rounded to half a millimetre per second and a degree; asked again, remembered.

        The loop asks at every cycle, and what it asks about hardly changes.
        """
        key = round(speed_mps / SPEED_STEP_MPS), round(direction_rad / DIRECTION_STEP_RAD) % 360
        if key not in self._known:
            self._known[key] = self.quality(key[0] * SPEED_STEP_MPS, key[1] * DIRECTION_STEP_RAD)
        return self._known[key]

    def quality(self, speed_mps: float, direction_rad: float) -> Array:
        """(n,) probability that each grasp holds while the object moves in the plane, direction in its own frame.

        Below the slowest speed trained with, a direction is mostly noise: the answer is then the mean over all
        directions at that speed.
        """
        if speed_mps < self.model.speeds_mps[0]:
            return self.at_rest
        part = self.model.motion_part(np.array([speed_mps]), np.array([direction_rad]))
        return sigmoid(self.model.hidden_to_logits(self.base + part))

    @cached_property
    def at_rest(self) -> Array:
        """(n,) the same for an object that hardly moves."""
        directions = np.linspace(0.0, 2.0 * np.pi, STILL_DIRECTIONS, endpoint=False)
        parts = self.model.motion_part(np.full(STILL_DIRECTIONS, self.model.speeds_mps[0]), directions)
        return np.mean([sigmoid(self.model.hidden_to_logits(self.base + part)) for part in parts], axis=0)


def sigmoid(logits: Array) -> Array:
    """Probabilities of log odds, without overflow."""
    return 0.5 + 0.5 * np.tanh(0.5 * logits)


def load_motion_aware(robot: str, object: str) -> MotionAwareModel:
    """The model of a hand and an object.

    Raises ``NotFoundError`` for unknown names, ``MissingResourceError`` for a model that was not built, and
    ``InvalidInputError`` for a file that is broken or belongs to something else.
    """
    check_pair(robot, object)
    return read_motion_aware(motion_aware_file(robot, object), robot, object)


def read_motion_aware(path: Path, robot: str, object: str) -> MotionAwareModel:
    """The model of that pair from a file; errors as ``load_motion_aware``."""
    label = _label(robot, object)
    arrays, facts = read(path, label)
    try:
        floats = {name: array.astype(np.float32) for name, array in arrays.items()}
        first, second, last = (_layer(floats, k) for k in range(3))
        slowest, fastest = (float(speed) for speed in facts["speeds_mps"])
        model = MotionAwareModel(
            robot,
            object,
            backoff_m=float(facts["backoff_m"]),
            speeds_mps=(slowest, fastest),
            center=floats["center"],
            scale=floats["scale"],
            layers=(first, second, last),
            facts=facts,
        )
        _check(model)
    except (KeyError, TypeError, ValueError) as error:
        raise label.refusal(path, error) from error
    return model


def save_motion_aware(model: MotionAwareModel, path: Path | None = None) -> Path:
    """Write a model where ``load_motion_aware`` finds it, or to ``path``; weights as float16, all of it or nothing."""
    arrays: Arrays = {"center": model.center, "scale": model.scale}
    for k, (weight, bias) in enumerate(model.layers):
        arrays |= {f"weight{k}": weight.astype(np.float16), f"bias{k}": bias}
    own = {"backoff_m": model.backoff_m, "speeds_mps": model.speeds_mps}
    label = _label(model.robot, model.object)
    return write(path or motion_aware_file(model.robot, model.object), label, arrays, {**model.facts, **own})


def motion_aware_file(robot: str, object: str) -> Path:
    """Where the model of that pair is kept."""
    return pair_file("motion_aware", robot, object)


def _layer(arrays: dict[str, Floats], k: int) -> Layer:
    return arrays[f"weight{k}"], arrays[f"bias{k}"]


def _check(model: MotionAwareModel) -> None:
    """Raises ``ValueError`` when the arrays do not make such a network."""
    hidden = len(model.layers[0][1])
    wanted = [(FEATURES,), (FEATURES,), (hidden, FEATURES), (hidden,), (hidden, hidden), (hidden,), (1, hidden), (1,)]
    arrays = [model.center, model.scale, *(array for layer in model.layers for array in layer)]
    found = [array.shape for array in arrays]
    if found != wanted:
        raise ValueError(f"arrays of {found}, expected {wanted}")
    if not all(np.isfinite(array).all() for array in arrays) or not (model.scale > 0.0).all():
        raise ValueError("numbers that are not finite, or a scale that is not positive")
    if not 0.0 < model.speeds_mps[0] <= model.speeds_mps[1]:
        raise ValueError(f"speeds from {model.speeds_mps[0]} to {model.speeds_mps[1]} m/s")


def _label(robot: str, object: str) -> Label:
    command = f"python -m backend build motion-aware --robot {robot} --object {object}"
    return Label(f"motion-aware model of {object} for {robot}", FORMAT, command, {"robot": robot, "object": object})
