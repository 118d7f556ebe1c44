"""Pairs: methods compared on the very same trials, and whether they really began the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from backend.experiments.grid.row import GridRow
from backend.experiments.report.analysis import Rows, time_s
from backend.experiments.report.statistics import (
    Interval,
    Paired,
    bootstrapped_mean,
    compare,
    holm,
    p_of_no_difference,
)
from backend.pose import Array

SIGNIFICANT = 0.05


@dataclass(frozen=True)
class Difference:
    """Something measured under both methods: mean over the pairs of the first's value minus the second's."""

    mean: Interval | None
    p: float
    """By a paired permutation test of that mean."""
    p_holm: float = 1.0
    """Corrected for all comparisons of the same kind."""

    @property
    def first_has_less(self) -> bool | None:
        """None where chance may have made the difference, at the 5 % level."""
        return None if self.mean is None or self.p_holm >= SIGNIFICANT else self.mean.value < 0.0


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
    time_s: Difference
    both_s: Interval | None
    """Mean difference in time where both succeeded."""
    way_rad: Difference
    """Length in joint space of the way that the arm takes in a trial."""

    @property
    def verdict(self) -> str:
        """In words, at the 5 % level."""
        said: dict[str, list[str]] = {}
        if self.p_holm < SIGNIFICANT:
            better = self.first if self.successes.difference > 0.0 else self.second
            said.setdefault(better, []).append("grasps more often")
        for difference, words in ((self.time_s, "goes in sooner"), (self.way_rad, "takes a shorter way")):
            less = difference.first_has_less
            if less is not None:
                said.setdefault(self.first if less else self.second, []).append(words)
        return ", ".join(f"{method} {_listed(how)}" for method, how in said.items()) or "no significant difference"


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
    of_success = holm([comparison.successes.p for comparison in found])
    of_time = holm([comparison.time_s.p for comparison in found])
    of_way = holm([comparison.way_rad.p for comparison in found])
    return [
        replace(
            comparison,
            p_holm=p_success,
            time_s=replace(comparison.time_s, p_holm=p_time),
            way_rad=replace(comparison.way_rad, p_holm=p_way),
        )
        for comparison, p_success, p_time, p_way in zip(found, of_success, of_time, of_way, strict=True)
    ]


def _compared(rows: Rows, robot: str, task: str | None, first: str, second: str) -> Comparison | None:
    """None where the methods are the same or have no trials in common."""
    one, other = (_trials(rows, robot, task, method) for method in (first, second))
    pairs = [(one[key], other[key]) for key in one if key in other]
    if first == second or not pairs:
        return None
    hits = np.array([[rows.success(row) for row in pair] for pair in pairs])
    both = [pair for pair, hit in zip(pairs, hits, strict=True) if hit.all()]
    return Comparison(
        robot=robot,
        task=task,
        first=first,
        second=second,
        successes=compare(hits[:, 0], hits[:, 1]),
        p_holm=1.0,
        time_s=_difference(_differences(pairs, time_s)),
        both_s=bootstrapped_mean(_differences(both, time_s)),
        way_rad=_difference(_differences(pairs, lambda row: row.joint_path_rad)),
    )


def _trials(rows: Rows, robot: str, task: str | None, method: str) -> dict[tuple[str, str, int], GridRow]:
    return {
        (row.task, row.object, row.index): row
        for row in rows.all
        if row.robot == robot and row.method == method and task in (None, row.task)
    }


def _difference(values: Array) -> Difference:
    return Difference(bootstrapped_mean(values), p_of_no_difference(values))


def _differences(pairs: Sequence[tuple[GridRow, GridRow]], of: Callable[[GridRow], float | None]) -> Array:
    values = [(of(first), of(second)) for first, second in pairs]
    return np.array([a - b for a, b in values if a is not None and b is not None])


def _listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
