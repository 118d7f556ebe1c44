"""Statistics of successes and times, by statsmodels and SciPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import bootstrap, permutation_test
from statsmodels.stats.contingency_tables import mcnemar
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.proportion import proportion_confint

from backend.pose import Array

CONFIDENCE = 0.95
RESAMPLES = 2000
SIGN_FLIPS = 9999
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Interval:
    """An estimate and its 95 % confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Paired:
    """Two methods on the same trials."""

    n: int
    only_first: int
    """Trials that only the first grasped."""
    only_second: int
    p: float
    """McNemar, exact, two-sided."""

    @property
    def difference(self) -> float:
        """Success of the first minus that of the second."""
        return (self.only_first - self.only_second) / self.n


def rate(successes: int, n: int) -> Interval:
    """Share of successes with Wilson's interval; n > 0."""
    interval: Any = proportion_confint(successes, n, alpha=1.0 - CONFIDENCE, method="wilson")
    low, high = interval
    return Interval(successes / n, float(low), float(high))


def compare(first: Flags, second: Flags) -> Paired:
    """Successes (n,) of two methods on the same n > 0 trials."""
    only_first, only_second = int((first & ~second).sum()), int((~first & second).sum())
    both, neither = int((first & second).sum()), int((~first & ~second).sum())
    test: Any = mcnemar([[both, only_first], [only_second, neither]], exact=True)
    return Paired(len(first), only_first, only_second, float(test.pvalue))


def holm(p: Sequence[float]) -> list[float]:
    """p-values corrected for being many (Holm 1979), in their order."""
    if not p:
        return []
    corrected: Any = multipletests(list(p), method="holm")
    return [float(value) for value in corrected[1]]


def p_of_no_difference(differences: Array, seed: int = 0) -> float:
    """Paired permutation test, two-sided: how likely differences (n,) are so large on average if signs are chance."""
    if len(differences) < 2 or not differences.any():
        return 1.0
    found: Any = permutation_test(
        (differences,),
        np.mean,
        permutation_type="samples",
        vectorized=True,
        n_resamples=SIGN_FLIPS,
        batch=500,
        rng=np.random.default_rng(seed),
    )
    return float(found.pvalue)


def bootstrapped_mean(values: Array, seed: int = 0) -> Interval | None:
    """Mean of values (n,), or of paired differences, with its percentile interval; None of fewer than two."""
    if len(values) < 2:
        return None
    mean = float(values.mean())
    if np.ptp(values) == 0.0:
        return Interval(mean, mean, mean)
    found = bootstrap(
        (values,),
        np.mean,
        n_resamples=RESAMPLES,
        batch=100,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(seed),
    )
    return Interval(mean, float(found.confidence_interval.low), float(found.confidence_interval.high))
