"""Ranking: the grasps of the last cycle's shortlist, what each was ranked by, and what became of it."""

from __future__ import annotations

from collections import Counter

import numpy as np
import viser

from app.ui import palette, words
from app.ui.desk import Desk
from app.ui.palette import rank_color
from app.ui.panels.panel import View
from app.ui.progress import AutoNext
from backend.pipeline.values import CycleResult, Shortlist
from backend.pose import Array

REASONS_SHOWN = 3


class RankingPanel:
    """The marks have the colours of the hands in the scene."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, auto_next: AutoNext) -> None:
        self._shown: CycleResult | None = None
        self._table = gui.add_html("")

    def show(self, view: View) -> None:
        snapshot = view.state.snapshot
        cycle = snapshot.cycle if snapshot else None
        if cycle is not self._shown:
            self._shown = cycle
            short = cycle.shortlist if cycle else None
            self._table.content = "" if cycle is None or short is None else ranking_html(cycle, short)


def ranking_html(cycle: CycleResult, short: Shortlist) -> str:
    """Kept grasps in order, and the commonest reasons of the others."""
    columns = _columns(short)
    heads = ("no.", *(head for head, _ in columns), "")
    rows: list[tuple[palette.Rgb, tuple[str, ...]]] = []
    for rank, i in enumerate(short.kept):
        picked = cycle.picked is not None and cycle.picked.index == i
        color = palette.PICKED if picked else rank_color(rank, len(short.kept))
        became = "picked" if picked else short.rejected.get(i, "")
        rows.append((color, (str(i), *(figures[i] for _, figures in columns), became)))
    others = words.heading("The others") + words.note(_of_the_others(short)) if short.rejected else ""
    return words.heading("Shortlist") + words.ranking(heads, rows) + others


def _columns(short: Shortlist) -> list[tuple[str, list[str]]]:
    """What the filter ranked by: reachability in centimetres, quality in motion in per cent, or its own score."""
    columns: list[tuple[str, list[str]]] = []
    if short.reachability_m is not None:
        columns.append(("R, cm", _figures(short.reachability_m, 100.0, 1)))
    if short.motion_quality is not None:
        columns.append(("M, %", _figures(short.motion_quality, 100.0, 0)))
    if not columns and np.isfinite(short.score).any():
        columns.append(("score", _figures(short.score, 1.0, 2)))
    return columns


def _figures(values: Array, unit: float, digits: int) -> list[str]:
    return [f"{unit * value:.{digits}f}" if np.isfinite(value) else "-" for value in values]


def _of_the_others(short: Shortlist) -> str:
    """Figures in a reason are left out, so that like is counted with like."""
    reasons = Counter(
        why.split(" by about")[0].split(";")[0] for i, why in short.rejected.items() if i not in short.kept
    )
    return "; ".join(f"{count}x {why}" for why, count in reasons.most_common(REASONS_SHOWN))
