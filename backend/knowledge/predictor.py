"""PredictorWeights: the trained network of motion prediction, and the facts of its making."""

from __future__ import annotations

import itertools
import json
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from backend.errors import InvalidInputError, MissingResourceError
from backend.files import replacing

Floats = NDArray[np.float32]
FORMAT = 1
COMMAND = "python -m backend build predictor"


@dataclass(frozen=True, eq=False)
class PredictorWeights:
    """LSTM(hidden), two Dense(hidden) and Dense(horizons x 4), in torch's layout and gate order (i, f, g, o)."""

    lstm_in: Floats
    """(4 hidden, features)."""
    lstm_hidden: Floats
    """(4 hidden, hidden)."""
    lstm_bias: Floats
    """(4 hidden,) the sum of torch's two biases."""
    dense: tuple[tuple[Floats, Floats], ...]
    """(weight (out, in), bias (out,)) of each layer."""
    facts: dict[str, Any] = field(default_factory=dict[str, Any])
    """How it was made: seed, settings, versions, metrics."""


def predictor_file() -> Path:
    """Where the weights that come with the project are kept."""
    return Path(__file__).parent.parent / "assets" / "predictor" / "lstm.npz"


def load_weights(features: int, outputs: int, path: Path | None = None) -> PredictorWeights:
    """The weights that come with the project, or those at ``path``, which must fit a network of that size.

    Raises ``MissingResourceError`` when there are none, ``InvalidInputError`` when the file is not whole or is
    not of such a network.
    """
    path = path or predictor_file()
    if not path.is_file():
        raise MissingResourceError(f"There is no trained predictor: {path} is missing. Make it with: {COMMAND}")
    weights = _read(path)
    hidden = weights.lstm_hidden.shape[-1]
    wanted = [(4 * hidden, features), (4 * hidden, hidden), (4 * hidden,)]
    sizes = [hidden] * len(weights.dense) + [outputs]
    for wide, narrow in itertools.pairwise(sizes):
        wanted += [(narrow, wide), (narrow,)]
    arrays = [weights.lstm_in, weights.lstm_hidden, weights.lstm_bias, *(a for layer in weights.dense for a in layer)]
    found = [array.shape for array in arrays]
    if found != wanted or not all(np.isfinite(array).all() for array in arrays):
        raise InvalidInputError(
            f"{path}: not the weights of this predictor (arrays of {found}, expected {wanted}, all finite). "
            f"Make them again with: {COMMAND}"
        )
    return weights


def _read(path: Path) -> PredictorWeights:
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as data:
            facts = cast(dict[str, Any], json.loads(str(data["facts"])))
            if facts.get("format") != FORMAT:
                raise InvalidInputError(
                    f"{path}: format {facts.get('format')}, this version reads {FORMAT}. Make it again with: {COMMAND}"
                )
            arrays = {name: data[name].astype(np.float32) for name in data.files if name != "facts"}
            dense = tuple((arrays[f"dense{k}_weight"], arrays[f"dense{k}_bias"]) for k in range(3))
            return PredictorWeights(arrays["lstm_in"], arrays["lstm_hidden"], arrays["lstm_bias"], dense, facts)
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        EOFError,
        zipfile.BadZipFile,
        zlib.error,
    ) as error:
        raise InvalidInputError(
            f"{path}: not a trained predictor, or not all of it ({error}). Make it again with: {COMMAND}"
        ) from error


def save_weights(weights: PredictorWeights, path: Path | None = None) -> Path:
    """Write the weights where ``load_weights`` finds them, or to ``path``; all of it or nothing."""
    path = path or predictor_file()
    arrays = {"lstm_in": weights.lstm_in, "lstm_hidden": weights.lstm_hidden, "lstm_bias": weights.lstm_bias}
    for k, (weight, bias) in enumerate(weights.dense):
        arrays |= {f"dense{k}_weight": weight, f"dense{k}_bias": bias}
    facts = np.array(json.dumps({**weights.facts, "format": FORMAT}, sort_keys=True))
    with replacing(path) as file:
        np.savez_compressed(file, allow_pickle=False, facts=facts, **arrays)
    return path
