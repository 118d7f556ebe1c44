"""Trial: what is happening, in words and figures, and how it ended."""

from __future__ import annotations

import viser

from app.state import SessionState
from app.ui import palette, words
from app.ui.desk import Desk
from app.ui.panels.panel import View
from app.ui.progress import AutoNext, Tally
from backend.pipeline.values import CycleResult, Room

ROOMS: tuple[Room, ...] = ("predict", "convert", "filter", "pick", "plan", "retime")


class TrialPanel:
    """Display only: nothing here can be set from a browser."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, auto_next: AutoNext) -> None:
        self._banner = gui.add_html("")
        self._facts = gui.add_html("")
        self._cycle = gui.add_html("")

    def show(self, view: View) -> None:
        self._banner.content = _banner(view)
        self._facts.content = words.facts(_trial_rows(view.state, view.tally))
        snapshot = view.state.snapshot
        cycle = snapshot.cycle if snapshot else None
        self._cycle.content = "" if cycle is None else _cycle_html(cycle)


def _banner(view: View) -> str:
    state, snapshot = view.state, view.state.snapshot
    if state.looked_at is not None and snapshot is not None and state.status == "running":
        what = f"{words.PHASES[snapshot.phase]}. Go on from here, or back to the newest."
        return words.banner(f"Looking back at {snapshot.t_s:.1f} s", what, palette.SEED_PLAN)
    if state.status == "crashed":
        return words.banner("Simulation ended", state.crash.cause if state.crash else "", palette.BAD)
    if state.loading or snapshot is None:
        return words.banner("Loading", f"{state.info.title}, seed {state.restart.seed}", palette.QUIET)
    if snapshot.outcome is not None:
        headline, text = words.outcome_words(snapshot.outcome)
        color = words.outcome_color(snapshot.outcome)
        coming = "" if view.next_in_s is None else f" Next trial in {max(view.next_in_s, 0.0):.0f} s."
        return words.banner(headline, text + coming, color)
    text = ("Paused. " if state.pace.paused else "") + state.info.title
    return words.banner(words.PHASES[snapshot.phase], text, palette.BRAND)


def _trial_rows(state: SessionState, tally: Tally) -> list[tuple[str, str]]:
    snapshot = state.snapshot
    share = f" ({100 * tally.grasped / tally.ended:.0f} %)" if tally.ended else ""
    rows: list[tuple[str, str]] = []
    if snapshot is not None:
        distance_m = float(((snapshot.T_world_tcp.xyz_m - snapshot.T_world_object.xyz_m) ** 2).sum() ** 0.5)
        rows = [
            ("Simulated time", f"{snapshot.t_s:.1f} s"),
            ("Real-time factor", f"{state.pace.real_time_factor:.2f}"),
            ("Hand to object", f"{100 * distance_m:.1f} cm"),
            ("Cycles", str(snapshot.cycles)),
        ]
    return [*rows, ("Grasped so far", f"{tally.grasped} of {tally.ended}{share}")]


def _cycle_html(cycle: CycleResult) -> str:
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
    return words.heading("Last cycle") + words.facts(head) + words.bars(rows, palette.PLAN)
