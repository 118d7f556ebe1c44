"""What phases, reasons and figures are called on the page. Whatever comes from outside is escaped here."""

from __future__ import annotations

from html import escape

from app.ui.palette import ANCHOR, BAD, GOOD, QUIET, Rgb, css
from backend.pipeline.values import FailureReason, Outcome, Phase

PHASES: dict[Phase, str] = {
    "watch": "Watching",
    "move": "Moving to pregrasp",
    "approach": "Approaching",
    "close": "Closing hand",
    "lift": "Lifting",
    "hold": "Holding",
    "done": "Finished",
}

REASONS: dict[FailureReason, str] = {
    "never_reachable": "The object never came within reach.",
    "no_ik": "No joint angles reach any of the grasps.",
    "no_plan": "No way without a collision was found.",
    "approach_missed": "The hand closed beside the object.",
    "dropped": "The object slipped out of the hand.",
    "knocked_obstacle": "An obstacle was knocked.",
    "belt_end": "The belt came to its end first.",
    "object_fell": "The object fell off the belt.",
    "timeout": "The time was up.",
    "error": "The simulated world broke down.",
}

ROOMS = ("predict", "convert", "filter", "pick", "plan", "retime")


def outcome_words(outcome: Outcome) -> tuple[str, str]:
    """Headline and sentence."""
    if outcome.strict:
        return "Grasped", outcome.detail or "Lifted and held by the hand alone."
    reason = REASONS[outcome.reason] if outcome.reason else ""
    return "Not grasped", outcome.detail or reason


def banner(headline: str, text: str, color: Rgb) -> str:
    """HTML of a coloured block."""
    return (
        f'<div style="background:{css(color)};color:#fff;border-radius:6px;padding:8px 12px;margin:4px 8px">'
        f'<div style="font-size:1.15em;font-weight:700">{escape(headline)}</div>'
        f'<div style="font-size:0.85em;opacity:0.95">{escape(text)}</div></div>'
    )


def outcome_color(outcome: Outcome) -> Rgb:
    return GOOD if outcome.strict else BAD


def facts(rows: list[tuple[str, str]]) -> str:
    """HTML of names and values."""
    cells = "".join(
        f'<tr><td style="color:{css(QUIET)};padding:1px 10px 1px 0;white-space:nowrap">{escape(name)}</td>'
        f'<td style="text-align:right;font-variant-numeric:tabular-nums">{escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'<table style="width:calc(100% - 24px);margin:2px 12px;font-size:0.85em">{cells}</table>'


def bars(rows: list[tuple[str, float, str]], color: Rgb, name_px: int = 56, figure_px: int = 58) -> str:
    """HTML of horizontal bars: name, share in 0..1, figure."""
    lines = "".join(
        f'<div style="display:flex;align-items:center;gap:6px;font-size:0.8em">'
        f'<span style="width:{name_px}px;color:{css(QUIET)}">{escape(name)}</span>'
        f'<span style="flex:1;background:rgba(134,142,150,0.18);border-radius:2px;height:8px">'
        f'<span style="display:block;width:{100 * share:.0f}%;background:{css(color)};'
        f'height:8px;border-radius:2px"></span></span>'
        f'<span style="width:{figure_px}px;text-align:right;font-variant-numeric:tabular-nums">{escape(figure)}</span>'
        "</div>"
        for name, share, figure in rows
    )
    return f'<div style="margin:4px 12px">{lines}</div>'


def legend(rows: list[tuple[Rgb, str]]) -> str:
    """HTML of coloured marks with their meaning, in two columns."""
    marks = "".join(
        f'<span style="display:flex;align-items:center;gap:6px">'
        f'<span style="width:10px;height:10px;border-radius:3px;background:{css(color)}"></span>'
        f"{escape(text)}</span>"
        for color, text in rows
    )
    return (
        '<div style="display:grid;grid-template-columns:1fr 1fr;gap:3px 8px;margin:4px 12px;font-size:0.8em">'
        f"{marks}</div>"
    )


def ranking(heads: tuple[str, ...], rows: list[tuple[Rgb, tuple[str, ...]]], chosen: str = "") -> str:
    """HTML of a table whose rows begin with a coloured mark; the last column is words, the others are figures.

    The first figure says which grasp it is: a click on the row shows its card. That of ``chosen`` is marked.
    """
    title = "".join(f'<th style="{_cell(i, len(heads))}">{escape(head)}</th>' for i, head in enumerate(heads))
    lines = "".join(
        f'<tr data-grasp="{escape(row[0])}" tabindex="0" role="button" title="Show the card of grasp {escape(row[0])}" '
        f'style="cursor:pointer{";background:rgba(134,142,150,0.25)" if row[0] == chosen else ""}">'
        f'<td style="width:10px"><span style="display:block;width:8px;height:8px;border-radius:2px;'
        f'background:{css(color)}"></span></td>'
        + "".join(f'<td style="{_cell(i, len(row))}">{escape(text)}</td>' for i, text in enumerate(row))
        + "</tr>"
        for color, row in rows
    )
    style = "width:calc(100% - 24px);margin:2px 12px;font-size:0.8em;border-collapse:collapse;table-layout:fixed"
    head_style = f"color:{css(QUIET)};font-weight:400"
    return f'<table style="{style}"><tr style="{head_style}"><th style="width:10px"></th>{title}</tr>{lines}</table>'


def _cell(column: int, columns: int) -> str:
    if column < columns - 1:
        return "text-align:right;width:38px;padding-right:4px;font-variant-numeric:tabular-nums;font-weight:inherit"
    cut = "overflow:hidden;text-overflow:ellipsis;white-space:nowrap"
    return f"text-align:left;padding-left:6px;font-weight:inherit;{cut}"


def heading(text: str) -> str:
    """HTML of a small heading."""
    return (
        f'<div style="margin:8px 12px 2px;font-size:0.75em;font-weight:700;letter-spacing:0.05em;'
        f'text-transform:uppercase;color:{css(QUIET)}">{escape(text)}</div>'
    )


def note(text: str) -> str:
    """HTML of a quiet line."""
    style = f"margin:2px 12px 6px;font-size:0.8em;color:{css(QUIET)};overflow-wrap:anywhere"
    return f'<div style="{style}">{escape(text)}</div>'


def link_button(text: str, address: str, copy: bool = False) -> str:
    """HTML of a link that looks like a button; with ``copy`` a click copies the whole address instead."""
    return _button(text, address, "data-copy" if copy else "download")


def page_link(text: str, address: str) -> str:
    """HTML of a link, that looks like a button, to another page of this server."""
    return _button(text, address, 'target="_blank" rel="noopener"')


def _button(text: str, address: str, what: str) -> str:
    style = (
        f"display:block;margin:6px 12px;padding:5px 10px;border-radius:4px;border:1px solid {ANCHOR};"
        f"color:{ANCHOR};text-align:center;text-decoration:none;font-size:0.85em"
    )
    return f'<a href="{escape(address)}" {what} style="{style}">{escape(text)}</a>'


def tip(text: str) -> str:
    """HTML of a line that explains what stands below it."""
    style = f"margin:6px 12px 2px;font-size:0.78em;color:{css(QUIET)}"
    return f'<div style="{style}">{escape(text)}</div>'


def crash_text(cause: str, traceback: str) -> str:
    """HTML of a cause and, where there is one, its traceback."""
    details = (
        f'<pre style="max-height:300px;overflow:auto;font-size:0.75em;background:rgba(134,142,150,0.15);'
        f'padding:8px;border-radius:4px;white-space:pre-wrap">{escape(traceback)}</pre>'
        if traceback
        else ""
    )
    return f'<div style="padding:4px 8px"><p style="margin:4px 0">{escape(cause)}</p>{details}</div>'
