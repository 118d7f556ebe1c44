"""The report's figures, by Plotly, as values that become pieces of HTML sharing one script, or plain JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

from plotly import graph_objects, offline, subplots

from backend.experiments.report.analysis import Cell, Rows, Share, distance_bin_m, speed_bin_mps
from backend.experiments.report.paper import PapersCell
from backend.experiments.report.statistics import Interval

_go: Any = graph_objects
COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#999999", "#F0E442")
"""Okabe and Ito's, which colour-blind people tell apart."""
HEIGHT_PX = 420


Figure = Any
"""One of Plotly's, whose types it keeps to itself."""


def as_html(figure: Figure) -> str:
    """A piece of HTML; a page needs ``script()`` once before the first."""
    return str(figure.to_html(full_html=False, include_plotlyjs=False))


def as_table(figure: Figure) -> dict[str, Any]:
    """Data and layout as plain JSON, for Plotly's script."""
    return json.loads(figure.to_json())


def script() -> str:
    """Plotly itself, so that the report opens without a network."""
    return f"<script>{offline.get_plotlyjs()}</script>"


def figures(rows: Rows, linear: Rows, cells: Sequence[Cell]) -> list[Figure]:
    """Success and time by task; success by distance, speed and object; reasons of failure; cycle times.

    One panel for each robot. Distances are those of linear belts; where there are none, their figure is left out.
    """
    distance = "Success against distance of the belt from the base (linear motion)"
    by_distance = [_shares(linear, linear.shares(distance_bin_m), distance, "m")] if linear.all else []
    return [
        _by_task(rows, cells, "Success", "success", lambda cell: cell.success, lambda paper: paper.success),
        _by_task(rows, cells, "Time until the approach", "s", lambda cell: cell.time_s, lambda paper: paper.time_s),
        *by_distance,
        _shares(rows, rows.shares(speed_bin_mps), "Success against speed of the belt", "m/s"),
        _shares(rows, rows.shares(lambda row: row.object), "Success by object", "", bars=True),
        _reasons(rows),
        _cycles(rows),
    ]


def _by_task(
    rows: Rows,
    cells: Sequence[Cell],
    what: str,
    unit: str,
    ours: Callable[[Cell], Interval | None],
    papers: Callable[[PapersCell], float],
) -> Figure:
    """Bars with intervals; a line across each is what the paper reports."""

    def draw(robot: str, method: str) -> list[Any]:
        own = [
            (cell, found)
            for cell in cells
            if (cell.robot, cell.method) == (robot, method) and (found := ours(cell)) is not None
        ]
        tasks = [cell.task for cell, _ in own]
        mark = {"symbol": "line-ew", "size": 12, "line": {"width": 2, "color": "black"}}
        lines = _go.Scatter(
            x=tasks,
            y=[papers(cell.paper) if cell.paper else None for cell, _ in own],
            mode="markers",
            marker=mark,
            offsetgroup=method,
            hovertemplate=f"{method}, paper: %{{y:.3f}}<extra></extra>",
            showlegend=False,
        )
        return [_bar(tasks, [found for _, found in own], offsetgroup=method), lines]

    return _panels(rows, f"{what} by task, with 95 % intervals; lines are the paper's", "", unit, draw)


def _shares(rows: Rows, shares: Sequence[Share], title: str, unit: str, *, bars: bool = False) -> Figure:
    def draw(robot: str, method: str) -> list[Any]:
        own = [share for share in shares if (share.robot, share.method) == (robot, method)]
        kinds, rates = [share.kind for share in own], [share.success for share in own]
        return [_bar(kinds, rates) if bars else _line(kinds, rates)]

    return _panels(rows, title, unit, "success", draw)


def _reasons(rows: Rows) -> Figure:
    """Stacked by reason, one bar per method."""
    counts = rows.reasons()
    names = sorted({reason for counter in counts.values() for reason in counter})
    figure = subplots.make_subplots(cols=len(rows.robots), shared_yaxes=True, subplot_titles=rows.robots)
    for column, robot in enumerate(rows.robots, start=1):
        methods = [method for method in rows.methods if (robot, method) in counts]
        totals = [sum(row.robot == robot and row.method == method for row in rows.all) for method in methods]
        for name, color in zip(names, COLORS * 2, strict=False):
            shares = [counts[robot, m][name] / n for m, n in zip(methods, totals, strict=True)]
            bar = _go.Bar(x=methods, y=shares, name=name, legendgroup=name, marker_color=color, showlegend=column == 1)
            figure.add_trace(bar, row=1, col=column)
    figure.update_layout(barmode="stack")
    return _done(figure, "Failures by the strict rule", "share of trials")


def _cycles(rows: Rows) -> Figure:
    def draw(robot: str, method: str) -> list[Any]:
        means = [row.cycle_mean_ms for row in rows.all if (row.robot, row.method) == (robot, method)]
        return [_go.Box(y=[mean for mean in means if mean is not None], boxpoints=False)]

    return _panels(rows, "Mean wall time of a trial's cycles", "", "ms", draw)


def _panels(rows: Rows, title: str, x: str, y: str, draw: Callable[[str, str], list[Any]]) -> Figure:
    """One panel per robot, one colour per method."""
    figure = subplots.make_subplots(cols=len(rows.robots), shared_yaxes=True, subplot_titles=rows.robots)
    for column, robot in enumerate(rows.robots, start=1):
        for method, color in zip(rows.methods, COLORS * 8, strict=False):
            for trace in draw(robot, method):
                trace.update(name=method, legendgroup=method, marker_color=color)
                if trace.showlegend is None:
                    trace.showlegend = column == 1
                figure.add_trace(trace, row=1, col=column)
    figure.update_xaxes(title=x)
    figure.update_layout(scattermode="overlay" if x else "group")
    return _done(figure, title, y)


def _bar(kinds: Sequence[Any], rates: Sequence[Interval], **more: Any) -> Any:
    return _go.Bar(x=list(kinds), y=[rate.value for rate in rates], error_y=_errors(rates), **more)


def _line(kinds: Sequence[Any], rates: Sequence[Interval]) -> Any:
    values = [rate.value for rate in rates]
    return _go.Scatter(x=list(kinds), y=values, error_y=_errors(rates), mode="lines+markers")


def _errors(rates: Sequence[Interval]) -> dict[str, Any]:
    up, down = [rate.high - rate.value for rate in rates], [rate.value - rate.low for rate in rates]
    return {"type": "data", "array": up, "arrayminus": down, "thickness": 1, "width": 2}


def _done(figure: Figure, title: str, y: str) -> Figure:
    figure.update_layout(title=title, template="plotly_white", height=HEIGHT_PX)
    figure.update_yaxes(title=y, col=1, rangemode="tozero")
    return figure
