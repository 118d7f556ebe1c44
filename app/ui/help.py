"""Help: what the page is about in five cards, and its keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape

import viser

from app.ui.memory import Memory
from app.ui.palette import ANCHOR, BRAND, QUIET, css

KEY = "toured"
SHORTCUTS: tuple[tuple[str, str], ...] = (
    ("Space", "play or pause"),
    ("\u2192  \u2190", "one tick on, one tick back (also T, B)"),
    ("R", "the same trial again from its start"),
    ("N", "the next seed"),
    ("1  2  3  4", "camera: overview, above, side, close"),
    ("L", "light or dark"),
    ("H", "this help"),
)
MOUSE: tuple[tuple[str, str], ...] = (
    ("Drag", "turn the view; right button moves it, wheel zooms"),
    ("Drag an obstacle", "put it elsewhere, while the trial runs"),
    ("Click a small hand", "show the card of that grasp; so does its row in the tab Grasps"),
    ("Click the timeline", "look back at that moment; so does a click on a plot"),
)


@dataclass(frozen=True)
class Card:
    """One step of the tour."""

    title: str
    text: str


CARDS = (
    Card(
        "A robot grasps what moves",
        "An object rides on a belt whose motion the arm is not told. The arm watches, predicts, plans again and again, "
        "closes in, and lifts. Space pauses and plays.",
    ),
    Card(
        "Left: what happens, and why",
        "The coloured block says what the arm is doing and how the trial ended. The tab Grasps shows how a hundred "
        "grasps come down to one, with the reason for every rejection; Signals plots what is measured.",
    ),
    Card(
        "Right: what you can change",
        "Belt speed acts at once. Scenario, task, sensing and every part of the method restart the trial with the same "
        "seed, so that you see what the change does. Compare with, in the tab Method, runs two methods side by side.",
    ),
    Card(
        "Below: the last minute",
        "Drag along the timeline to look back. Go on from here plays the trial on from that moment as if what came "
        "after had not been.",
    ),
    Card(
        "Take it along",
        "Copy link, in the tab Share, leads to exactly this trial with your edits. Scenario, trace and outcome can be "
        "downloaded there. H shows this help with all keys.",
    ),
)


class Guide:
    """Dialogs for one browser at a time."""

    def __init__(self, memory: Memory, tour: bool) -> None:
        self._memory = memory
        self._tour = tour

    def welcome(self, client: viser.ClientHandle) -> None:
        """The tour, for whoever comes for the first time."""
        if self._tour and self._memory.recall(client, KEY) is None:
            self._memory.keep(client, KEY, "1")
            self.tour(client)

    def tour(self, client: viser.ClientHandle, number: int = 0) -> None:
        """One card after the other."""
        card, last = CARDS[number], number == len(CARDS) - 1
        modal = client.gui.add_modal(f"{card.title} ({number + 1} of {len(CARDS)})")
        with modal:
            client.gui.add_html(card_html(card, number))
            on = client.gui.add_button("Start" if last else "Next", icon=viser.Icon.ARROW_RIGHT)
            skip = client.gui.add_button("Skip the tour", color="gray", visible=not last)
        _on_click(skip, modal.close)
        _on_click(on, lambda: (modal.close(), None if last else self.tour(client, number + 1)))

    def help(self, client: viser.ClientHandle) -> None:
        """Keys and mouse."""
        modal = client.gui.add_modal("Help")
        with modal:
            client.gui.add_html(keys_html("Keys", SHORTCUTS) + keys_html("Mouse", MOUSE) + LINKS)
            again = client.gui.add_button("Show the tour", color="gray")
            close = client.gui.add_button("Close")
        _on_click(close, modal.close)
        _on_click(again, lambda: (modal.close(), self.tour(client)))


def _on_click(button: viser.GuiButtonHandle, act: Callable[[], object]) -> None:
    async def on_event(_: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
        act()

    button.on_click(on_event)


def card_html(card: Card, number: int) -> str:
    """HTML of a card's text, and of how far the tour has come."""
    dots = "".join(
        f'<span style="width:8px;height:8px;border-radius:4px;background:{css(BRAND if i == number else QUIET)};'
        f'opacity:{1 if i == number else 0.35}"></span>'
        for i in range(len(CARDS))
    )
    return (
        f'<div style="padding:4px 8px 12px;line-height:1.5">{escape(card.text)}</div>'
        f'<div style="display:flex;gap:6px;justify-content:center;margin-bottom:8px">{dots}</div>'
    )


def keys_html(title: str, rows: tuple[tuple[str, str], ...]) -> str:
    """HTML of keys and what they do."""
    cell = f"border:1px solid {css(QUIET)};border-radius:4px;padding:1px 7px;font-size:0.85em;white-space:nowrap"
    lines = "".join(
        f'<tr><td style="padding:3px 14px 3px 0;white-space:nowrap"><span style="{cell}">{escape(key)}</span></td>'
        f'<td style="padding:3px 0">{escape(what)}</td></tr>'
        for key, what in rows
    )
    head = f'<div style="font-weight:700;margin:6px 0 2px;color:{css(QUIET)}">{escape(title)}</div>'
    return f'<div style="padding:0 8px">{head}<table style="font-size:0.9em">{lines}</table></div>'


LINKS = (
    '<div style="padding:8px;font-size:0.9em">Many trials at once: '
    f'<a href="/experiments" target="_blank" rel="noopener" style="color:{ANCHOR}">experiments</a>. '
    "Everything here can be scripted: "
    f'<a href="/api/docs" target="_blank" rel="noopener" style="color:{ANCHOR}">API docs</a>.</div>'
)
