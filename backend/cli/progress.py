"""What a grid says while it runs: rows, rate, time left, and how often each method succeeds."""

from __future__ import annotations

import time

from backend.cli.telling import Teller
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName
from backend.experiments.grid.store import Store


class Progress:
    """Counts rows: those that are in the store already, and those that come."""

    def __init__(self, total: int, store: Store, judge: JudgeName) -> None:
        self.tell = Teller()
        self._total = total
        self._judge: JudgeName = judge
        self._successes: dict[str, list[int]] = {}
        self._done = self._new = self._errors = 0
        self._begun_s = time.monotonic()
        for row in store.rows():
            self._count(row)

    def row(self, row: GridRow) -> None:
        """Tell of one more row."""
        self._count(row)
        self._new += 1
        self.tell(self.line())

    def line(self) -> str:
        """Rows, rate, time left, and the share of successes of each method."""
        rate = self._new / max(time.monotonic() - self._begun_s, 1e-9)
        left_s = (self._total - self._done) / rate if rate > 0.0 else 0.0
        shares = ", ".join(f"{name} {sum(hits) / len(hits):.3f}" for name, hits in self._successes.items())
        errors = f", {self._errors} errors" if self._errors else ""
        hours, minutes = divmod(round(left_s / 60.0), 60)
        left = f"{hours} h {minutes:02d} min left{errors}"
        return f"{self._done} of {self._total}, {rate:.2f}/s, {left}; {self._judge}: {shares}"

    def _count(self, row: GridRow) -> None:
        self._done += 1
        self._errors += row.reason == "error"
        self._successes.setdefault(row.method, []).append(row.strict if self._judge == "strict" else row.authors)
