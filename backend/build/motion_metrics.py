"""How good probabilities are against what happened, and the temperature that makes them honest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.knowledge.motion_aware import sigmoid
from backend.pose import Array

Bools = NDArray[np.bool_]
BINS = 10
BLUNTEST, SHARPEST = 0.05, 20.0


@dataclass(frozen=True)
class Agreement:
    """Probabilities of n attempts against their outcomes. Rates without a case are None."""

    n: int
    base_rate: float
    """Share that held: the accuracy of always saying so."""
    accuracy: float
    """Share for which a probability of at least one half went with holding."""
    false_positive_rate: float | None
    """Of those that did not hold, the share said to hold."""
    false_negative_rate: float | None
    """Of those that held, the share said not to."""
    brier: float
    """Mean squared difference of probability and outcome (Brier 1950)."""
    calibration_error: float
    """Expected calibration error over ``BINS`` equal bins of probability (Naeini et al. 2015)."""
    log_loss: float


def agreement(probability: Array, held: Bools) -> Agreement:
    """Compare probabilities (n,) with outcomes (n,); n must not be zero."""
    said = probability >= 0.5
    safe = np.clip(probability, 1e-7, 1.0 - 1e-7)
    return Agreement(
        n=len(held),
        base_rate=float(held.mean()),
        accuracy=float((said == held).mean()),
        false_positive_rate=_share(said[~held]),
        false_negative_rate=_share(~said[held]),
        brier=float(((probability - held) ** 2).mean()),
        calibration_error=calibration_error(probability, held),
        log_loss=float(-np.where(held, np.log(safe), np.log1p(-safe)).mean()),
    )


def calibration_error(probability: Array, held: Bools) -> float:
    """Mean over attempts of how far their bin's mean probability lies from its share that held."""
    bins = np.minimum((probability * BINS).astype(np.int64), BINS - 1)
    off = np.bincount(bins, weights=probability - held, minlength=BINS)
    return float(np.abs(off).sum() / len(held))


def best_sharpness(logits: Array, held: Bools) -> float:
    """The factor on log odds that makes outcomes likeliest: 1 / temperature (Guo et al. 2017).

    The likelihood's slope falls with the factor, so its zero is found by halving, between ``BLUNTEST`` and
    ``SHARPEST``.
    """
    low, high = BLUNTEST, SHARPEST
    for _ in range(60):
        middle = 0.5 * (low + high)
        slope = float(((held - sigmoid(middle * logits)) * logits).sum())
        low, high = (middle, high) if slope > 0.0 else (low, middle)
    return 0.5 * (low + high)


def _share(flags: Bools) -> float | None:
    return float(flags.mean()) if len(flags) else None
