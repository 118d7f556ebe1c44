"""Tells how far a long command is: a line with a bar on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

from rich.console import Console
from rich.control import Control
from rich.progress_bar import ProgressBar
from rich.segment import ControlType
from rich.table import Table
from rich.text import Text

LINE_EVERY_S = 30.0
BAR_WIDTH = 24
_NUMBER = re.compile(r"\d+(?:[.,]\d+)*")
_OF = re.compile(r"\b(\d+) of (\d+)\b")
_PERCENT = re.compile(r"\b(\d+) %")
_ONE_UP = Control.move(0, -1), Control((ControlType.ERASE_IN_LINE, 2))


class Teller:
    """Takes progress in words, as ``OnProgress`` does, and leads every line by ``words``.

    Texts that begin alike, up to a comma and but for numbers, are news of one thing: on a terminal the newer one takes
    the older one's place; elsewhere one is told every ``LINE_EVERY_S``, besides the first, the one that says that all
    is done, and the last before news of something else.
    """

    def __init__(
        self, *words: str, console: Console | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._lead = " ".join(words)
        self._console = console or Console(stderr=True, highlight=False)
        self._clock = clock
        self._told_s = 0.0
        self._thing: str | None = None
        self._held_back: str | None = None
        self._rows = 0

    def __call__(self, text: str) -> None:
        thing = _NUMBER.sub("", text).split(",")[0]
        goes_on, self._thing = thing == self._thing, thing
        line = f"{self._lead}: {text}" if self._lead else text
        if self._console.is_terminal:
            self._draw(line, share(text), goes_on)
            return
        if not goes_on and self._held_back is not None:
            self._print(self._held_back)
        if goes_on and share(text) != 1.0 and self._clock() - self._told_s < LINE_EVERY_S:
            self._held_back = line
        else:
            self._print(line)

    def _draw(self, line: str, done: float | None, in_place: bool) -> None:
        if in_place:
            self._console.control(*_ONE_UP * self._rows)
        table = Table.grid(padding=(0, 1))
        bar = [] if done is None else [ProgressBar(1.0, done, width=BAR_WIDTH)]
        table.add_row(*bar, Text(line))
        self._rows = len(self._console.render_lines(table))
        self._console.print(table)

    def _print(self, line: str) -> None:
        self._held_back, self._told_s = None, self._clock()
        self._console.print(Text(line), soft_wrap=True)


def share(text: str) -> float | None:
    """How much is done, 0 to 1, of a text that says "12 of 40" or "30 %"; None of any other."""
    if (found := _OF.search(text)) and int(found[2]):
        return min(int(found[1]) / int(found[2]), 1.0)
    return min(int(found[1]) / 100.0, 1.0) if (found := _PERCENT.search(text)) else None
