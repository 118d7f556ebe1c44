"""Progress of a grid: a live bar on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.text import Text

from backend.cli.telling import LINE_EVERY_S
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName
from backend.experiments.grid.store import Store


class Progress:
    """Counts rows: those that are in the store already, and those that come."""

    def __init__(self, total: int, store: Store, judge: JudgeName) -> None:
        self._total = total
        self._judge: JudgeName = judge
        self._successes: dict[str, list[int]] = {}
        self._done = self._new = self._errors = 0
        self._begun_s = self._told_s = time.monotonic()
        for row in store.rows():
            self._count(row)
        console = Console(stderr=True)
        self._live = Live(console=console, refresh_per_second=4) if console.is_terminal else None

    def __enter__(self) -> Self:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def row(self, row: GridRow) -> None:
        """Show one more row."""
        self._count(row)
        self._new += 1
        if self._live is not None:
            bar = ProgressBar(total=self._total, completed=self._done, width=60)
            self._live.update(Group(bar, Text(self.line())))
        elif self._done == self._total or time.monotonic() - self._told_s >= LINE_EVERY_S:
            self._told_s = time.monotonic()
            print(self.line(), file=sys.stderr, flush=True)

    def line(self) -> str:
        """Rows, rate, time left, and the share of successes of each method."""
        rate = self._new / max(time.monotonic() - self._begun_s, 1e-9)
        left_s = (self._total - self._done) / rate if rate > 0.0 else 0.0
        shares = ", ".join(f"{name} {sum(hits) / len(hits):.3f}" for name, hits in self._successes.items())
        errors = f", {self._errors} errors" if self._errors else ""
        hours, minutes = divmod(round(left_s / 60.0), 60)
        left = f"{hours} h {minutes:02d} min left{errors}"
        return f"{self._done}/{self._total}, {rate:.2f}/s, {left}; {self._judge}: {shares}"

    def _count(self, row: GridRow) -> None:
        self._done += 1
        self._errors += row.reason == "error"
        self._successes.setdefault(row.method, []).append(row.strict if self._judge == "strict" else row.authors)
