"""Plot: lines over the last minute as HTML, with what each comes to at the moment shown; a click looks back there."""

from __future__ import annotations

from html import escape

import numpy as np

from app.ui.palette import BAD, QUIET, css
from app.ui.signals import Line, Plot
from backend.pose import Array

WIDTH, HEIGHT = 1000, 100
HEIGHT_PX = 60
STEPS = (1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
"""Where a scale may end, times a power of ten."""
USUAL = 0.95
"""Share of the figures that a plot with bursts is scaled for; the others run out at the top."""


def plot_html(plot: Plot, span: tuple[float, float], shown_s: float, looked_at: bool) -> str:
    """One plot: title with unit and largest figure, the lines, a line at the moment looked at, and figures."""
    top = nice_top(highest(plot))
    lines = _areas(plot, span, top) if plot.stacked else "".join(_path(line, span, top) for line in plot.lines)
    marks = ""
    if plot.limit is not None and plot.limit <= top:
        marks += _stroke(f"M0 {_y(plot.limit, top)}H{WIDTH}", css(BAD), "1", ' stroke-dasharray="4 3"')
    if looked_at:
        marks += _stroke(f"M{_x(shown_s, span)} 0V{HEIGHT}", css(BAD), "2")
    svg = (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" preserveAspectRatio="none" width="100%" height="{HEIGHT_PX}" '
        f'style="display:block;background:rgba(134,142,150,0.10)">{lines}{marks}</svg>'
    )
    return (
        f'<div style="margin:6px 12px 0;font-size:10px;color:{css(QUIET)}">'
        f'<div style="display:flex;justify-content:space-between;font-size:11px"><b>{escape(plot.title)}</b>'
        f"<span>{top:g} {escape(plot.unit)}</span></div>"
        f'<div data-strip="{span[0]:g} {span[1]:g}" style="cursor:pointer">{svg}</div>'
        f"{_figures(plot, shown_s)}</div>"
    )


def highest(plot: Plot) -> float:
    """Of any line, or of their sum where they are parts of one; bursts left out; 0 where there is none."""
    rows = [line.values for line in plot.lines if line.values.size]
    if not rows:
        return 0.0
    values = np.sum(rows, axis=0) if plot.stacked else np.concatenate(rows)
    finite = values[np.isfinite(values)]
    return float(np.quantile(finite, USUAL if plot.bursts else 1.0)) if finite.size else 0.0


def nice_top(value: float) -> float:
    """The least end of a scale that is not below ``value``, so that the scale does not change at every tick."""
    if value <= 0.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(value))
    return float(next(step * decade for step in STEPS if step * decade >= value * (1.0 - 1e-9)))


def _path(line: Line, span: tuple[float, float], top: float) -> str:
    parts: list[str] = []
    pen_down = False
    for t_s, value in zip(line.t_s.tolist(), line.values.tolist(), strict=True):
        known = np.isfinite(value) and t_s >= span[0]
        if known:
            parts.append(f"{'L' if pen_down else 'M'}{_x(t_s, span)} {_y(value, top)}")
        pen_down = known
    return _stroke("".join(parts), css(line.color), "1.5") if parts else ""


def _areas(plot: Plot, span: tuple[float, float], top: float) -> str:
    """Each line's share on top of those before it."""
    out: list[str] = []
    below: Array | None = None
    for line in plot.lines:
        inside = line.t_s >= span[0]
        t_s, values = line.t_s[inside], line.values[inside]
        low = np.zeros_like(values) if below is None else below
        below = low + values
        if not values.any():
            continue
        upper = [f"{_x(t, span)} {_y(y, top)}" for t, y in zip(t_s, below, strict=True)]
        lower = [f"{_x(t, span)} {_y(y, top)}" for t, y in zip(t_s[::-1], low[::-1], strict=True)]
        out.append(f'<path d="M{"L".join([*upper, *lower])}Z" fill="{css(line.color)}"/>')
    return "".join(out)


def _figures(plot: Plot, shown_s: float) -> str:
    items = "".join(
        f'<span style="white-space:nowrap"><span style="display:inline-block;width:7px;height:7px;border-radius:2px;'
        f'margin-right:3px;background:{css(line.color)}"></span>{escape(line.name)} '
        f'<span style="font-variant-numeric:tabular-nums">{_figure(line.at(shown_s))}</span></span>'
        for line in plot.lines
    )
    return f'<div style="display:flex;flex-wrap:wrap;column-gap:8px;line-height:13px">{items}</div>'


def _figure(value: float) -> str:
    return "-" if not np.isfinite(value) else f"{value:.0f}" if value >= 10.0 else f"{value:.1f}"


def _stroke(path: str, color: str, width: str, more: str = "") -> str:
    looks = f'stroke="{color}" stroke-width="{width}"{more} vector-effect="non-scaling-stroke"'
    return f'<path d="{path}" fill="none" {looks}/>'


def _x(t_s: float, span: tuple[float, float]) -> int:
    return round(WIDTH * (t_s - span[0]) / (span[1] - span[0]))


def _y(value: float, top: float) -> int:
    return round(HEIGHT * (1.0 - min(max(value / top, 0.0), 1.0)))
