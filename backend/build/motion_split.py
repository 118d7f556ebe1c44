"""Parts of a body of attempts: what is learnt from, what decides when to stop, and two ways to be tested."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.build.attempts import Ids
from backend.errors import InvalidInputError


@dataclass(frozen=True)
class SplitSettings:
    """Shares of the parts; the rest is for training."""

    validation: float = 0.10
    trials: float = 0.10
    grasps: float = 0.10
    """Of the database's grasps, not of the attempts."""


@dataclass(frozen=True, eq=False)
class Split:
    """Rows of a body of attempts, each in one part only."""

    training: NDArray[np.int64]
    validation: NDArray[np.int64]
    """Chooses the epoch and calibrates."""
    trials: NDArray[np.int64]
    """Other attempts at grasps that are trained on: what the published figures are measured on, and what happens in
    use, where the database's grasps are ranked."""
    grasps: NDArray[np.int64]
    """Attempts at grasps none of which, perturbed or not, is in another part."""


def split(grasp: Ids, seed: int, settings: SplitSettings | None = None) -> Split:
    """Parts of attempts whose database grasps are ``grasp`` (n,).

    Raises ``InvalidInputError`` when a part would be empty.
    """
    s = settings or SplitSettings()
    rng = np.random.default_rng(seed)
    families = rng.permutation(np.unique(grasp))
    away = families[: max(1, round(s.grasps * len(families)))]
    unseen = np.isin(grasp, away)
    rest = rng.permutation(np.flatnonzero(~unseen))
    ends = np.cumsum([round(s.validation * len(rest)), round(s.trials * len(rest))])
    validation, trials, training = np.split(rest, ends)
    parts = Split(np.sort(training), np.sort(validation), np.sort(trials), np.flatnonzero(unseen))
    if min(map(len, (parts.training, parts.validation, parts.trials, parts.grasps))) == 0:
        raise InvalidInputError(f"{len(grasp)} attempts at {len(families)} grasps are too few to train and test with")
    return parts
