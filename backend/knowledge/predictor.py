"""PredictorWeights: the trained network of motion prediction, and the facts of its making."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.knowledge.shelf import ASSETS, Arrays, Label, read, write

Floats = NDArray[np.float32]
Layer = tuple[Floats, Floats]
LABEL = Label("trained predictor", 2, "python -m backend build predictor")


@dataclass(frozen=True, eq=False)
class PredictorWeights:
    """LSTM(hidden), two Dense(hidden) and Dense(horizons x 4), in torch's layout and gate order (i, f, g, o).

    Beside the three, from the LSTM as well, Dense(hidden) and Dense(horizons) say how far off that may be.
    """

    lstm_in: Floats
    """(4 hidden, features)."""
    lstm_hidden: Floats
    """(4 hidden, hidden)."""
    lstm_bias: Floats
    """(4 hidden,) the sum of torch's two biases."""
    dense: tuple[Layer, ...]
    """(weight (out, in), bias (out,)) of each layer."""
    spread: tuple[Layer, ...]
    """The same of the layers that say how far off."""
    facts: dict[str, Any] = field(default_factory=dict[str, Any])
    """How it was made: seed, settings, versions, metrics."""


def predictor_file() -> Path:
    """Where the weights that come with the project are kept."""
    return ASSETS / "predictor" / "lstm.npz"


def load_weights(features: int, horizons: int, path: Path | None = None) -> PredictorWeights:
    """The weights that come with the project, or those at ``path``, which must fit a network of that size.

    Raises ``MissingResourceError`` when there are none, ``InvalidInputError`` when the file is not whole or is
    not of such a network.
    """
    path = path or predictor_file()
    weights = _read(path)
    hidden = weights.lstm_hidden.shape[-1]
    wanted = [(4 * hidden, features), (4 * hidden, hidden), (4 * hidden,)]
    for layers, outputs in ((weights.dense, 4 * horizons), (weights.spread, horizons)):
        for wide, narrow in itertools.pairwise([hidden] * len(layers) + [outputs]):
            wanted += [(narrow, wide), (narrow,)]
    layers = (*weights.dense, *weights.spread)
    arrays = [weights.lstm_in, weights.lstm_hidden, weights.lstm_bias, *(array for layer in layers for array in layer)]
    found = [array.shape for array in arrays]
    if found != wanted or not all(np.isfinite(array).all() for array in arrays):
        raise LABEL.refusal(path, f"arrays of {found}, expected {wanted}, all finite")
    return weights


def _read(path: Path) -> PredictorWeights:
    arrays, facts = read(path, LABEL)
    try:
        floats = {name: array.astype(np.float32) for name, array in arrays.items()}
        dense, spread = (
            tuple((floats[f"{name}{k}_weight"], floats[f"{name}{k}_bias"]) for k in range(count))
            for name, count in (("dense", 3), ("spread", 2))
        )
        return PredictorWeights(floats["lstm_in"], floats["lstm_hidden"], floats["lstm_bias"], dense, spread, facts)
    except (KeyError, ValueError) as error:
        raise LABEL.refusal(path, error) from error


def save_weights(weights: PredictorWeights, path: Path | None = None) -> Path:
    """Write the weights where ``load_weights`` finds them, or to ``path``; all of it or nothing."""
    arrays: Arrays = {"lstm_in": weights.lstm_in, "lstm_hidden": weights.lstm_hidden, "lstm_bias": weights.lstm_bias}
    for name, layers in (("dense", weights.dense), ("spread", weights.spread)):
        for k, (weight, bias) in enumerate(layers):
            arrays |= {f"{name}{k}_weight": weight, f"{name}{k}_bias": bias}
    return write(path or predictor_file(), LABEL, arrays, weights.facts)
