"""Ranking: the funnel of the last cycle, the shortlist with its figures, and the card of any grasp."""

from __future__ import annotations

import viser

from app.ui import palette, words
from app.ui.desk import Answer, Desk
from app.ui.funnel import card_rows, columns, funnel, ranges, rejections
from app.ui.palette import rank_color
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.scores import SCORES
from backend.pipeline.values import CycleResult, Shortlist

EMPTY = "No grasps are ranked yet: press Play. The first cycle comes once the object has been seen."
NOBODY = -1
"""Stands for no grasp in the number box."""


class RankingPanel:
    """The marks have the colours of the hands in the scene."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        shared = desk.session.state.view
        self._shown: tuple[object, ...] = (None, shared)
        self._funnel = gui.add_html(words.tip(EMPTY))
        with gui.add_folder("Small hands"):
            self._score = gui.add_dropdown(
                "Colour by", tuple(SCORES), initial_value=shared.grasps_by, hint="What the small hands are coloured by"
            )
            self._number = gui.add_number(
                "Grasp no.", NOBODY, step=1, hint="Show the card of this grasp, as a click on it does; -1 for none"
            )
            self._card = gui.add_html("")
        self._table = gui.add_html("")
        self._score.on_update(choosing(desk, "score", lambda name: desk.change_view(grasps_by=name)))
        self._number.on_update(choosing(desk, "number", self.set_grasp))

    def show(self, view: View) -> None:
        snapshot, shared = view.state.snapshot, view.state.view
        self._desk.mirror("score", self._score, shared.grasps_by)
        self._desk.mirror("number", self._number, NOBODY if shared.grasp is None else shared.grasp)
        cycle = snapshot.cycle if snapshot else None
        if (cycle, shared) == self._shown:
            return
        self._shown = cycle, shared
        short = cycle.shortlist if cycle else None
        self._funnel.content = words.tip(EMPTY) if cycle is None or short is None else funnel_html(cycle, short)
        self._table.content = "" if cycle is None or short is None else ranking_html(cycle, short, shared.grasp)
        self._card.content = "" if cycle is None or short is None else card_html(cycle, short, shared.grasp)

    def set_grasp(self, index: object) -> Answer:
        """Show the card of that grasp, or none; raises ``InvalidInputError`` for a number that no database has."""
        return self._desk.change_view(grasp=None if index == NOBODY else index)


def funnel_html(cycle: CycleResult, short: Shortlist) -> str:
    """One bar per room, and what they say together."""
    stages = funnel(short, cycle.picked)
    most = max(stages[0].count, 1)
    rows = [(stage.name, stage.count / most, str(stage.count)) for stage in stages]
    return words.heading("From all grasps to one") + words.bars(rows, palette.PLAN, name_px=96, figure_px=28)


def ranking_html(cycle: CycleResult, short: Shortlist, chosen: int | None = None) -> str:
    """Kept grasps in order, then every other with its reason."""
    figures = columns(short)
    heads = ("no.", *(head for head, _ in figures), "")
    rows: list[tuple[palette.Rgb, tuple[str, ...]]] = []
    for rank, i in enumerate(short.kept):
        picked = cycle.picked is not None and cycle.picked.index == i
        color = palette.PICKED if picked else rank_color(rank, len(short.kept))
        became = "picked" if picked else short.rejected.get(i, "")
        rows.append((color, (str(i), *(column[i] for _, column in figures), became)))
    others = [words.note(f"{len(indices)}x {why}: {ranges(indices)}") for why, indices in rejections(short)]
    table = words.heading("Shortlist") + words.ranking(heads, rows, str(chosen))
    return table + (words.heading("Rejected, and why") + "".join(others) if others else "")


def card_html(cycle: CycleResult, short: Shortlist, index: int | None) -> str:
    """All that is known of one grasp; a hint while none is chosen."""
    if index is None or index >= len(short.score):
        return words.tip("Click a hand in the scene, or a row of the shortlist, to see its card.")
    return words.heading(f"Grasp {index}") + words.facts(card_rows(short, index, cycle.picked))
