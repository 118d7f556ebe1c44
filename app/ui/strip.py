"""Strip: the last minute of a trial as a band of phases with a mark for every cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from app.history import KEPT_S, Moment
from app.ui.contenders import Contender
from app.ui.palette import BAD, CYCLE, LINK, PHASES, QUIET, css
from app.ui.words import PHASES as PHASE_WORDS
from backend.pipeline.values import Phase

SHORTEST_S = 15.0
"""What the strip spans at least, so that a trial's beginning is not stretched."""
WIDTH, BAND, MARKS = 1000, 16, 9
FEWEST_UNITS = 70
"""A phase narrower than this is not labelled."""


@dataclass(frozen=True)
class Stretch:
    """A phase, and how long it lasted."""

    phase: Phase
    begin_s: float
    end_s: float


def stretches(moments: Sequence[Moment]) -> list[Stretch]:
    """The phases in their order, each up to the beginning of the next."""
    out: list[Stretch] = []
    for moment in moments:
        phase, t_s = moment.snapshot.phase, moment.snapshot.t_s
        if out and out[-1].phase == phase:
            out[-1] = Stretch(phase, out[-1].begin_s, t_s)
            continue
        if out:
            out[-1] = Stretch(out[-1].phase, out[-1].begin_s, t_s)
        out.append(Stretch(phase, t_s, t_s))
    return out


def cycle_times(moments: Sequence[Moment]) -> tuple[list[float], list[float]]:
    """When cycles began that led to a plan, and those that were refused."""
    planned: list[float] = []
    refused: list[float] = []
    last = None
    for moment in moments:
        cycle = moment.snapshot.cycle
        if cycle is not None and cycle is not last:
            last = cycle
            (planned if cycle.refused_by is None else refused).append(cycle.observed_s)
    return planned, refused


def span_s(moments: Sequence[Moment]) -> tuple[float, float]:
    """First and last time that the strip shows."""
    if not moments:
        return 0.0, SHORTEST_S
    end_s = moments[-1].t_s
    begin_s = max(0.0, end_s - KEPT_S)
    return begin_s, max(end_s, begin_s + SHORTEST_S)


def strip_svg(moments: Sequence[Moment], looked_at_s: float | None, compared: Sequence[Contender] = ()) -> str:
    """A band of phases, marks for its cycles, a line at the moment looked at; two bands where two are compared."""
    span = span_s(moments)
    bands = [_band(moments, span, looked_at_s)]
    if compared:
        beside = [Moment(moment.beside.snapshot, None) for moment in moments if moment.beside]
        lanes = zip(compared, (bands[0], _band(beside, span, looked_at_s)), strict=True)
        bands = [_caption(contender) + band for contender, band in lanes]
    ends = f"<span>{span[0]:.0f} s</span>{_key()}<span>{span[1]:.0f} s</span>"
    scale = f'<div style="display:flex;justify-content:space-between">{ends}</div>'
    return (
        f'<div style="margin:4px 12px 0;font-size:10px;color:{css(QUIET)}">'
        f'<div data-strip="{span[0]:g} {span[1]:g}" style="cursor:pointer">{"".join(bands)}</div>'
        f"{scale}</div>"
    )


def _band(moments: Sequence[Moment], span: tuple[float, float], looked_at_s: float | None) -> str:
    begin_s, end_s = span

    def x(t_s: float) -> float:
        return round(WIDTH * (t_s - begin_s) / (end_s - begin_s), 1)

    parts = [f'<rect width="{WIDTH}" height="{BAND}" rx="3" fill="{css(QUIET)}" opacity="0.15"/>']
    labels: list[str] = []
    for part in stretches(moments):
        left, width = x(part.begin_s), max(x(part.end_s) - x(part.begin_s), 1.0)
        title = f"{PHASE_WORDS[part.phase]}, {part.begin_s:.1f} to {part.end_s:.1f} s"
        parts.append(
            f'<rect x="{left}" width="{width:.1f}" height="{BAND}" fill="{css(PHASES[part.phase])}">'
            f"<title>{escape(title)}</title></rect>"
        )
        if width >= FEWEST_UNITS:
            share = 100 * (left + width / 2) / WIDTH
            labels.append(
                f'<span style="position:absolute;left:{share:.1f}%;top:1px;transform:translateX(-50%);color:#fff;'
                f'font-size:10px;line-height:14px;pointer-events:none">{part.phase}</span>'
            )
    planned, refused = cycle_times(moments)
    for times, color, top in ((planned, css(CYCLE), BAND + 2), (refused, css(BAD), BAND + 2)):
        path = "".join(f"M{x(t_s)} {top}v{MARKS - 2}" for t_s in times if t_s >= begin_s)
        parts.append(f'<path d="{path}" stroke="{color}" stroke-width="2" vector-effect="non-scaling-stroke"/>')
    if looked_at_s is not None:
        line = f"M{x(looked_at_s)} 0v{BAND + MARKS}"
        parts.append(f'<path d="{line}" stroke="{css(BAD)}" stroke-width="2" vector-effect="non-scaling-stroke"/>')
    size = f'viewBox="0 0 {WIDTH} {BAND + MARKS}" preserveAspectRatio="none" width="100%" height="{BAND + MARKS}"'
    svg = f'<svg {size} style="display:block">{"".join(parts)}</svg>'
    return f'<div style="position:relative">{svg}{"".join(labels)}</div>'


def _caption(contender: Contender) -> str:
    """Above a band: which method it is, and what has become of it."""
    color = LINK if contender.outcome is None else contender.color  # readable in light and dark
    style = f"font-size:11px;font-weight:600;line-height:15px;color:{css(color)}"
    return f'<div style="{style}">{escape(contender.words)}</div>'


def _key() -> str:
    marks = ((CYCLE, "cycle with a plan"), (BAD, "cycle refused"))
    items = "".join(
        f'<span><span style="display:inline-block;width:3px;height:8px;background:{css(color)};margin:0 5px 0 12px">'
        f"</span>{text}</span>"
        for color, text in marks
    )
    return f"<span>{items}</span>"
