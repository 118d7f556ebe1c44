"""Teaches the predictor how far off it may be: the distance that one position in twenty is off by, at each horizon.

By quantile regression (Koenker and Bassett 1978, doi:10.2307/1913643) on the log of the distance in units of the
network's answer, so that a micrometre on a clean belt counts like a decimetre under noise. The network is left alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from backend.build.predictor_network import Network, Spread
from backend.build.sequences import Sequences, SequenceSettings, draw_sequences
from backend.pipeline.predict.window import HORIZONS_S, MIN_BINS, normalised
from backend.pose import Array

QUANTILE = 0.95
LEAST = 1e-6
"""Smaller distances, in units of the answer, count as this."""
TRAINING, VALIDATION = 2, 3


@dataclass(frozen=True)
class SpreadSettings:
    """How much training; on sequences like the network's own."""

    steps: int = 4000
    batch: int = 320
    rate: float = 2e-3
    """Adam's, falling to zero along half a cosine."""
    validation: int = 4000


def learn_spread(
    network: Network, seed: int, settings: SpreadSettings, sequences: SequenceSettings
) -> tuple[Spread, dict[str, Any]]:
    """Layers for ``network``, and how often they are right on sequences never learnt from.

    Same arguments, same weights on the same machine. The network's two biases become one.
    """
    network.fold_biases()
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        spread = Spread()
    optimizer = torch.optim.Adam(spread.parameters())
    for step in range(settings.steps):
        for group in optimizer.param_groups:
            group["lr"] = settings.rate * 0.5 * (1.0 + math.cos(math.pi * step / settings.steps))
        drawn = draw_sequences(settings.batch, np.random.default_rng([seed, TRAINING, step]), sequences)
        remembered, off = _off(network, drawn)
        above = torch.from_numpy(np.log(np.maximum(off, LEAST)).astype(np.float32)) - spread(remembered)
        loss = torch.maximum(QUANTILE * above, (QUANTILE - 1.0) * above).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    drawn = draw_sequences(settings.validation, np.random.default_rng([seed, VALIDATION]), sequences)
    return spread, {"within": _within(network, spread, drawn).round(4).tolist(), "horizons_s": HORIZONS_S.tolist()}


def _off(network: Network, drawn: Sequences) -> tuple[Tensor, Array]:
    """What the network has remembered (n, HIDDEN) of the n sequences it can answer, and how far off it is, in units of
    its answer (n, horizons)."""
    windows = normalised(drawn.age_s, drawn.states, drawn.seen)
    known = np.flatnonzero((windows.lengths >= MIN_BINS) & (windows.scale[:, 0, 0] > 1e-9))
    tokens, lengths = torch.from_numpy(windows.tokens[known]), torch.from_numpy(windows.lengths[known])
    with torch.no_grad():
        remembered = network.remembered(tokens, lengths)
        answer = network.answer(remembered).double().numpy()
    wanted = drawn.future - windows.states(np.zeros_like(drawn.future))
    off = (wanted @ windows.turn)[known, :, :3] / windows.scale[known, :, :3] - answer[..., :3]
    return remembered, np.linalg.norm(off, axis=2)


def _within(network: Network, spread: Spread, drawn: Sequences) -> Array:
    """(horizons,) share of the positions that are off by no more than was said."""
    remembered, off = _off(network, drawn)
    with torch.no_grad():
        return (np.log(np.maximum(off, LEAST)) <= spread(remembered).numpy()).mean(axis=0)
