"""Analysis: what a grid's rows add up to, as plain values that any format can show."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName
from backend.experiments.report.paper import PapersCell, papers_cell
from backend.experiments.report.statistics import Interval, bootstrapped_mean, rate

DISTANCE_BIN_M = 0.05
SPEED_BIN_MPS = 0.005
KindOf = Callable[[GridRow], float | str | None]


@dataclass(frozen=True)
class Cell:
    """One robot, task and method."""

    robot: str
    task: str
    method: str
    n: int
    success: Interval
    time_s: Interval | None
    """Time to the approach over all trials, with its bootstrapped interval."""
    succeeded_s: float | None
    """Time to the approach, of the successes only."""
    lifted_s: float | None
    """Time to the end of the lift, of the successes only."""
    paper: PapersCell | None

    @property
    def success_gain(self) -> float | None:
        """Success minus the paper's."""
        return None if self.paper is None else self.success.value - self.paper.success

    @property
    def time_gain_s(self) -> float | None:
        """Time minus the paper's; negative is faster."""
        return None if self.paper is None or self.time_s is None else self.time_s.value - self.paper.time_s


@dataclass(frozen=True)
class Share:
    """Success of one robot and method among trials of one kind."""

    robot: str
    method: str
    kind: float | str
    """A distance, a speed, an object."""
    n: int
    success: Interval


@dataclass(frozen=True)
class Cycles:
    """What thinking took, of one robot and method."""

    robot: str
    method: str
    trials: int
    per_trial: float
    mean_ms: float
    """Wall time of a cycle: mean over the trials of their means."""
    p95_ms: float
    """Median over the trials of their 95th percentiles."""
    joint_path_rad: float


class Rows:
    """The rows of one grid under one judge; an ``error`` is a failure."""

    def __init__(self, rows: Iterable[GridRow], judge: JudgeName) -> None:
        self.all = sorted(rows, key=lambda row: row.key)
        self.judge: JudgeName = judge
        self.robots = self._names("robot")
        self.tasks = self._names("task")
        self.objects = self._names("object")
        self.methods = self._names("method")

    def ordered(self, robots: Sequence[str], tasks: Sequence[str], methods: Sequence[str]) -> Rows:
        """The same rows, names in the order of the settings."""
        self.robots = [name for name in robots if name in self.robots]
        self.tasks = [name for name in tasks if name in self.tasks]
        self.methods = [name for name in methods if name in self.methods]
        return self

    def success(self, row: GridRow) -> bool:
        """By the judge."""
        return row.strict if self.judge == "strict" else row.authors

    def cells(self) -> list[Cell]:
        """The paper's table: robot by robot, method by method, task by task; those without rows are left out."""
        groups = self._groups(lambda row: (row.robot, row.method, row.task))
        order = [(robot, method, task) for robot in self.robots for method in self.methods for task in self.tasks]
        return [self._cell(groups[key]) for key in order if key in groups]

    def shares(self, kind_of: KindOf) -> list[Share]:
        """Success by whatever ``kind_of`` says of a row; rows it says None of are left out."""
        groups: dict[tuple[str, str, Any], list[GridRow]] = {}
        for row in self.all:
            kind = kind_of(row)
            if kind is not None:
                groups.setdefault((row.robot, row.method, kind), []).append(row)
        kinds = sorted({kind for _, _, kind in groups})
        order = [(robot, method, kind) for robot in self.robots for method in self.methods for kind in kinds]
        return [Share(*key, len(groups[key]), self._rate(groups[key])) for key in order if key in groups]

    def reasons(self) -> dict[tuple[str, str], Counter[str]]:
        """Robot, method -> how often each reason of failure, by the strict rule."""
        groups = self._groups(lambda row: (row.robot, row.method))
        return {
            (robot, method): Counter(row.reason for row in groups[robot, method] if row.reason is not None)
            for robot in self.robots
            for method in self.methods
            if (robot, method) in groups
        }

    def cycles(self) -> list[Cycles]:
        """Thinking, by robot and method."""
        groups = self._groups(lambda row: (row.robot, row.method))
        out: list[Cycles] = []
        for robot, method in ((robot, method) for robot in self.robots for method in self.methods):
            rows = [row for row in groups.get((robot, method), []) if row.cycle_mean_ms is not None]
            if rows:
                columns = [(row.cycles, row.cycle_mean_ms, row.joint_path_rad) for row in rows]
                per_trial, mean_ms, path_rad = np.array(columns, dtype=np.float64).mean(axis=0).tolist()
                p95_ms = float(np.median([row.cycle_p95_ms or 0.0 for row in rows]))
                out.append(Cycles(robot, method, len(rows), per_trial, mean_ms, p95_ms, path_rad))
        return out

    def _cell(self, rows: list[GridRow]) -> Cell:
        first = rows[0]
        successes = [row for row in rows if self.success(row)]
        times = [t for row in rows if (t := time_s(row)) is not None]
        return Cell(
            robot=first.robot,
            task=first.task,
            method=first.method,
            n=len(rows),
            success=self._rate(rows),
            time_s=bootstrapped_mean(np.array(times)),
            succeeded_s=_mean([time_s(row) for row in successes]),
            lifted_s=_mean([row.lift_end_s for row in successes]),
            paper=papers_cell(first.robot, first.task, first.method),
        )

    def _rate(self, rows: list[GridRow]) -> Interval:
        return rate(sum(map(self.success, rows)), len(rows))

    def _names(self, column: str) -> list[str]:
        return list(dict.fromkeys(str(getattr(row, column)) for row in self.all))

    def _groups(self, key: Callable[[GridRow], tuple[object, ...]]) -> dict[tuple[object, ...], list[GridRow]]:
        groups: dict[tuple[object, ...], list[GridRow]] = {}
        for row in self.all:
            groups.setdefault(key(row), []).append(row)
        return groups


def time_s(row: GridRow) -> float | None:
    """Until the approach began, or until the trial was over where none did; None of an error."""
    return row.end_s if row.approach_start_s is None else row.approach_start_s


def distance_bin_m(row: GridRow) -> float | None:
    """Middle of the 5 cm that the belt's distance lies in."""
    if row.distance_m is None:
        return None
    bin_number = math.floor(row.distance_m / DISTANCE_BIN_M + 1e-9)
    return round((bin_number + 0.5) * DISTANCE_BIN_M, 6)


def speed_bin_mps(row: GridRow) -> float | None:
    """The belt's speed to half a centimetre per second."""
    return None if row.speed_mps is None else round(round(row.speed_mps / SPEED_BIN_MPS) * SPEED_BIN_MPS, 6)


def _mean(values: Sequence[float | None]) -> float | None:
    """Of the values that are there; None when there are none."""
    there = [value for value in values if value is not None]
    return float(np.mean(there)) if there else None
