"""How long a grid takes, from its own rows or from what was measured elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from backend.experiments.grid.row import GridRow

ENOUGH = 20
TYPICAL_S = 1.2
"""Wall time of a trial over the paper's mix, on one core of an AMD EPYC of 2 GHz."""


@dataclass(frozen=True)
class Duration:
    """An estimate."""

    each_s: float
    hours: float
    source: str
    """What it is made from."""

    @property
    def words(self) -> str:
        """The time, as people would say it."""
        minutes = 60.0 * self.hours
        return f"about {self.hours:.1f} h" if minutes >= 90 else f"about {max(minutes, 1.0):.0f} min"


def how_long(trials: int, workers: int, rows: Sequence[GridRow]) -> Duration:
    """Time for so many more trials, given the rows there are."""
    took = [row.wall_s for row in rows if row.wall_s is not None]
    if len(took) >= ENOUGH:
        each_s, source = fmean(took), f"the {len(took)} done took {fmean(took):.2f} s each"
    else:
        each_s, source = TYPICAL_S, f"{TYPICAL_S:g} s each, as on a core of a server of 2024"
    return Duration(each_s, trials * each_s / workers / 3600.0, source)
