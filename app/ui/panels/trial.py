"""Trial: what is happening, in words and figures, and how it ended."""

from __future__ import annotations

import numpy as np
import viser

from app.reports import Traces
from app.state import SessionState
from app.ui import palette, words
from app.ui.contenders import Contender, contenders
from app.ui.desk import Desk
from app.ui.panels.panel import View
from app.ui.progress import Tally
from app.ui.replanning import change_words
from backend.pipeline.values import CycleResult, Room
from backend.snapshot import Snapshot

ROOMS: tuple[Room, ...] = ("predict", "convert", "filter", "pick", "plan", "retime")


class TrialPanel:
    """Display only: nothing here can be set from a browser."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._banner = gui.add_html("")
        self._facts = gui.add_html("")
        self._cycle = gui.add_html("")

    def show(self, view: View) -> None:
        self._banner.content = _banner(view)
        self._facts.content = words.facts(_trial_rows(view.state, view.tally))
        snapshot = view.state.snapshot
        cycle = snapshot.cycle if snapshot else None
        whose = view.state.info.method if view.state.beside else ""
        self._cycle.content = "" if cycle is None else _cycle_html(cycle, view.state.traces, whose)


def _banner(view: View) -> str:
    compared = contenders(view.state)
    notice = _notice(view)
    if compared:
        return notice + "".join(_verdict(contender, view.next_in_s) for contender in compared)
    return notice or _progress(view)


def _notice(view: View) -> str:
    """What must be known before all else; empty when the trial simply goes on or has ended."""
    state, snapshot = view.state, view.state.snapshot
    if state.looked_at is not None and snapshot is not None and state.status == "running":
        what = f"{words.PHASES[snapshot.phase]}. Go on from here, or back to the newest."
        return words.banner(f"Looking back at {state.looked_at.t_s:.1f} s", what, palette.SEED_PLAN)
    if state.status == "crashed":
        return words.banner("Simulation ended", state.crash.cause if state.crash else "", palette.BAD)
    if state.loading or snapshot is None:
        return words.banner("Loading", f"{state.info.title}, seed {state.restart.seed}", palette.QUIET)
    return ""


def _progress(view: View) -> str:
    state, snapshot = view.state, view.state.snapshot
    assert snapshot is not None
    if snapshot.outcome is not None:
        headline, text = words.outcome_words(snapshot.outcome)
        return words.banner(headline, text + _coming(view.next_in_s), words.outcome_color(snapshot.outcome))
    text = ("Paused. " if state.pace.paused else "") + state.info.title
    return words.banner(words.PHASES[snapshot.phase], text, palette.BRAND)


def _verdict(contender: Contender, next_in_s: float | None) -> str:
    """A block for one of two methods."""
    text = contender.state[:1].upper() + contender.state[1:] + "."
    if contender.outcome is not None:
        text += ("" if contender.outcome.strict else f" {contender.outcome.detail}") + _coming(next_in_s)
    return words.banner(contender.method, text, contender.color)


def _coming(next_in_s: float | None) -> str:
    return "" if next_in_s is None else f" Next trial in {max(next_in_s, 0.0):.0f} s."


def _trial_rows(state: SessionState, tally: Tally) -> list[tuple[str, str]]:
    """Of two that are compared both figures, left and right."""
    share = f" ({100 * tally.grasped / tally.ended:.0f} %)" if tally.ended else ""
    if state.snapshot is None or state.newest is None:
        return [("Grasped so far", f"{tally.grasped} of {tally.ended}{share}")]
    both = [state.snapshot, *([] if state.beside is None else [state.beside.snapshot])]
    grasped = f"{tally.grasped}" if state.beside is None else f"{tally.grasped} / {tally.grasped_beside}"
    return [
        ("Simulated time", f"{state.newest.t_s:.1f} s"),
        ("Real-time factor", f"{state.pace.real_time_factor:.2f}"),
        ("Hand to object", " / ".join(f"{100 * _gap_m(one):.1f}" for one in both) + " cm"),
        ("Cycles", " / ".join(str(one.cycles) for one in both)),
        ("Grasped so far", f"{grasped} of {tally.ended}" + (share if state.beside is None else "")),
    ]


def _gap_m(snapshot: Snapshot) -> float:
    return float(np.linalg.norm(snapshot.T_world_tcp.xyz_m - snapshot.T_world_object.xyz_m))


def _cycle_html(cycle: CycleResult, traces: Traces | None, whose: str) -> str:
    times = {room: cycle.room_s.get(room, 0.0) for room in ROOMS}
    longest_s, total_s = max(*times.values(), 1e-6), sum(cycle.room_s.values())
    rows = [(room, seconds / longest_s, f"{1e3 * seconds:.1f} ms") for room, seconds in times.items()]
    kept = len(cycle.shortlist.kept) if cycle.shortlist else 0
    count = len(cycle.shortlist.score) if cycle.shortlist else 0
    verdict = cycle.plan.how if cycle.plan else f"{cycle.refused_by}: {cycle.why}" if cycle.refused_by else "-"
    head = [
        ("Whole cycle", f"{1e3 * total_s:.1f} ms"),
        ("Grasps kept", f"{kept} of {count}"),
        ("Plan", verdict),
    ]
    return (
        words.heading(f"Last cycle {whose}")
        + words.facts(head)
        + words.bars(rows, palette.PLAN)
        + words.heading("New plan against the one before")
        + words.note(change_words(cycle, traces))
    )
