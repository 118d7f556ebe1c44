"""Pairs: methods compared on the very same trials, and whether they really began the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from backend.experiments.grid.row import GridRow
from backend.experiments.report.analysis import Rows, time_s
from backend.experiments.report.statistics import Interval, Paired, bootstrapped_mean, compare, holm

SIGNIFICANT = 0.05


@dataclass(frozen=True)
class Comparison:
    """The reference method against another one, of one robot, in one task or in all."""

    robot: str
    task: str | None
    """None: all tasks."""
    first: str
    second: str
    successes: Paired
    p_holm: float
    """Corrected for all comparisons of the same kind: those of single tasks, or those over all tasks."""
    time_s: Interval | None
    """Mean over the pairs of the first's time minus the second's."""
    both_s: Interval | None
    """The same where both succeeded."""

    @property
    def verdict(self) -> str:
        """In words, at the 5 % level."""
        if self.p_holm >= SIGNIFICANT:
            return "no significant difference"
        return f"{self.first if self.successes.difference > 0.0 else self.second} grasps significantly more often"


def comparisons(rows: Rows, reference: str) -> list[Comparison]:
    """``reference`` against every other method: robot by robot over all tasks, then in each task."""
    over_all = [_compared(rows, robot, None, reference, other) for robot in rows.robots for other in rows.methods]
    single = [
        _compared(rows, robot, task, reference, other)
        for robot in rows.robots
        for task in rows.tasks
        for other in rows.methods
    ]
    return [*_corrected([c for c in over_all if c is not None]), *_corrected([c for c in single if c is not None])]


def odd_pairs(rows: Rows) -> int:
    """How many trials did not begin the same under every method that has a row of them."""
    starts: dict[tuple[str, str, str, int], set[str]] = {}
    for row in rows.all:
        if row.start:
            starts.setdefault((row.robot, row.task, row.object, row.index), set()).add(row.start)
    return sum(len(found) > 1 for found in starts.values())


def _corrected(found: Sequence[Comparison]) -> list[Comparison]:
    corrected = holm([comparison.successes.p for comparison in found])
    return [replace(comparison, p_holm=p) for comparison, p in zip(found, corrected, strict=True)]


def _compared(rows: Rows, robot: str, task: str | None, first: str, second: str) -> Comparison | None:
    """None where the methods are the same or have no trials in common."""
    one, other = (_trials(rows, robot, task, method) for method in (first, second))
    pairs = [(one[key], other[key]) for key in one if key in other]
    if first == second or not pairs:
        return None
    hits = np.array([[rows.success(row) for row in pair] for pair in pairs])
    return Comparison(
        robot=robot,
        task=task,
        first=first,
        second=second,
        successes=compare(hits[:, 0], hits[:, 1]),
        p_holm=1.0,
        time_s=_time_difference(pairs),
        both_s=_time_difference([pair for pair, hit in zip(pairs, hits, strict=True) if hit.all()]),
    )


def _trials(rows: Rows, robot: str, task: str | None, method: str) -> dict[tuple[str, str, int], GridRow]:
    return {
        (row.task, row.object, row.index): row
        for row in rows.all
        if row.robot == robot and row.method == method and task in (None, row.task)
    }


def _time_difference(pairs: Sequence[tuple[GridRow, GridRow]]) -> Interval | None:
    times = [(time_s(first), time_s(second)) for first, second in pairs]
    return bootstrapped_mean(np.array([a - b for a, b in times if a is not None and b is not None]))
