"""The report's tables: the paper's, cell by cell, pair by pair, by kind of trial, reasons and cycle times."""

from __future__ import annotations

from collections.abc import Sequence

from backend.experiments.report.analysis import Cell, Rows, Share, distance_bin_m, speed_bin_mps
from backend.experiments.report.pairs import Comparison
from backend.experiments.report.paper import PAPERS_TRIALS
from backend.experiments.report.statistics import Interval
from backend.experiments.report.table import Table
from backend.methods import METHODS
from backend.robots import ROBOTS
from backend.tasks import TASKS

TIME_NOTE = (
    "Time: until the approach began, or until the trial was over where none did, averaged over all trials, failed ones "
    "included, which is what the paper's evaluation averaged."
)
PAPER_NOTE = (
    f"Entries: success with its Wilson 95 % interval, mean time; below, the difference to the paper's entry (n = "
    f"{PAPERS_TRIALS}) and n. " + TIME_NOTE
)


def papers_tables(cells: Sequence[Cell], rows: Rows) -> list[Table]:
    """The paper's table of each arm: same rows, same columns."""
    by_key = {(cell.robot, cell.method, cell.task): cell for cell in cells}
    return [
        Table(
            f"table_{robot}",
            f"Success and time: {ROBOTS[robot].title if robot in ROBOTS else robot}",
            ["", *(_task(task) for task in rows.tasks)],
            [
                [_method(method), *(_entry(by_key.get((robot, method, task))) for task in rows.tasks)]
                for method in rows.methods
            ],
            PAPER_NOTE,
        )
        for robot in rows.robots
    ]


def cells_table(cells: Sequence[Cell]) -> Table:
    """One line per cell, everything in columns of its own."""
    header = ["robot", "task", "method", "n", "success", "low", "high", "paper's success", "difference"]
    header += ["time s", "low", "high", "paper's time s", "difference", "time of successes s", "lifted after s"]
    lines = [
        [
            *(cell.robot, cell.task, cell.method, str(cell.n)),
            *_interval(cell.success, 3),
            _number(cell.paper and cell.paper.success, 3),
            _signed(cell.success_gain, 3),
            *_interval(cell.time_s, 2),
            _number(cell.paper and cell.paper.time_s, 2),
            _signed(cell.time_gain_s, 2),
            _number(cell.succeeded_s, 2),
            _number(cell.lifted_s, 2),
        ]
        for cell in cells
    ]
    return Table("cells", "Every cell", header, lines, TIME_NOTE)


def pairs_table(comparisons: Sequence[Comparison], *, single_tasks: bool) -> Table:
    """The reference method against the others, over all tasks or in each."""
    header = ["robot", "task", "methods", "pairs", "only first", "only second", "success difference", "p", "p (Holm)"]
    header += ["time difference s", "time: p (Holm)", "where both succeeded s"]
    header += ["way difference rad", "way: p (Holm)", "verdict"]
    lines = [
        [
            *(c.robot, c.task or "all", f"{c.first} / {c.second}", str(c.successes.n)),
            *(str(c.successes.only_first), str(c.successes.only_second), _signed(c.successes.difference, 3)),
            *(f"{c.successes.p:.2g}", f"{c.p_holm:.2g}", _with_interval(c.time_s.mean), f"{c.time_s.p_holm:.2g}"),
            *(_with_interval(c.both_s), _with_interval(c.way_rad.mean), f"{c.way_rad.p_holm:.2g}", c.verdict),
        ]
        for c in comparisons
        if (c.task is not None) == single_tasks
    ]
    where = "in each task" if single_tasks else "over all tasks"
    note = (
        "The same trials under both methods. Success: McNemar's exact test, two-sided, corrected by Holm for all lines "
        "of this table. Time, and way (its length in joint space): first minus second, with bootstrapped 95 % "
        "intervals, and a paired permutation test corrected likewise. The verdict says what is significant at 5 %."
    )
    return Table("pairs_by_task" if single_tasks else "pairs", f"Methods compared {where}", header, lines, note)


def share_tables(rows: Rows, linear: Rows) -> list[Table]:
    """Success by distance (of linear motion, if any, as in the paper's figure), speed and object."""
    distance = "Success by distance of the belt from the base, m"
    by_distance = [_shares("by_distance", distance, linear.shares(distance_bin_m), 3)] if linear.all else []
    return [
        *by_distance,
        _shares("by_speed", "Success by speed of the belt, m/s", rows.shares(speed_bin_mps), 3),
        _shares("by_object", "Success by object", rows.shares(lambda row: row.object), 0),
    ]


def reasons_table(rows: Rows) -> Table:
    """How often each reason of failure by the strict rule."""
    counts = rows.reasons()
    reasons = sorted({reason for counter in counts.values() for reason in counter})
    lines = [[robot, method, *(str(c[reason]) for reason in reasons)] for (robot, method), c in counts.items()]
    return Table("reasons", "Failures by the strict rule", ["robot", "method", *reasons], lines)


def cycles_table(rows: Rows) -> Table:
    """What thinking took."""
    header = ["robot", "method", "trials", "cycles a trial", "mean cycle ms", "95 % within ms", "joint path rad"]
    lines = [
        [
            c.robot,
            c.method,
            str(c.trials),
            f"{c.per_trial:.1f}",
            f"{c.mean_ms:.1f}",
            f"{c.p95_ms:.1f}",
            f"{c.joint_path_rad:.2f}",
        ]
        for c in rows.cycles()
    ]
    note = "Wall time on the machines that ran the trials; the 95 % are the median over the trials of theirs."
    return Table("cycles", "Cycle times and ways", header, lines, note)


def _shares(name: str, title: str, shares: Sequence[Share], digits: int) -> Table:
    kinds = [f"{s.kind:.{digits}f}" if isinstance(s.kind, float) else s.kind for s in shares]
    lines = [
        [s.robot, s.method, str(kind), str(s.n), *_interval(s.success, 3)]
        for s, kind in zip(shares, kinds, strict=True)
    ]
    return Table(name, title, ["robot", "method", name.removeprefix("by_"), "n", "success", "low", "high"], lines)


def _entry(cell: Cell | None) -> str:
    if cell is None:
        return ""
    s = cell.success
    time = "" if cell.time_s is None else f", {cell.time_s.value:.2f} s"
    apart = "" if cell.paper is None else f"{_signed(cell.success_gain, 3)}, {_signed(cell.time_gain_s, 2)} s; "
    return f"{s.value:.3f} ({s.low:.3f}-{s.high:.3f}){time}\n{apart}n {cell.n}"


def _interval(interval: Interval | None, digits: int) -> list[str]:
    if interval is None:
        return ["", "", ""]
    return [f"{value:.{digits}f}" for value in (interval.value, interval.low, interval.high)]


def _with_interval(interval: Interval | None) -> str:
    return "" if interval is None else f"{interval.value:+.2f} ({interval.low:+.2f} to {interval.high:+.2f})"


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def _signed(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:+.{digits}f}"


def _task(name: str) -> str:
    return TASKS[name].title if name in TASKS else name


def _method(name: str) -> str:
    return METHODS[name].title if name in METHODS else name
