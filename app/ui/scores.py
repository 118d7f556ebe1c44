"""SCORES: what the small hands can be coloured by."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.ui import palette
from app.ui.palette import Rgb, blend, rank_color
from app.view import Score
from backend.pipeline.values import Shortlist
from backend.pose import Array

FAR_M = 0.3
"""Reachability that counts as fully inside."""


def _by_rank(short: Shortlist) -> list[Rgb]:
    ranks = {index: rank for rank, index in enumerate(short.kept)}
    n = len(short.kept)
    return [rank_color(ranks[i], n) if i in ranks else palette.QUIET for i in range(len(short.score))]


def _by_reachability(short: Shortlist) -> list[Rgb]:
    return _graded(short, short.reachability_m, FAR_M)


def _by_motion(short: Shortlist) -> list[Rgb]:
    return _graded(short, short.motion_quality, 1.0)


def _by_lift(short: Shortlist) -> list[Rgb]:
    return _graded(short, short.candidates.quality, 1.0)


def _graded(short: Shortlist, values: Array | None, best: float) -> list[Rgb]:
    """Grey where the filter has not asked, red where the answer is no, else from orange to green."""
    if values is None:
        return [palette.QUIET] * len(short.score)
    shares = np.clip(values / best, 0.0, 1.0)
    scale = palette.RANKS[::-1]
    return [
        palette.QUIET if np.isnan(v) else palette.BAD if v <= 0.0 else blend(scale, float(share))
        for v, share in zip(values, shares, strict=True)
    ]


SCORES: dict[Score, Callable[[Shortlist], list[Rgb]]] = {
    "Rank": _by_rank,
    "Reachability": _by_reachability,
    "Quality in motion": _by_motion,
    "Lift success": _by_lift,
}
