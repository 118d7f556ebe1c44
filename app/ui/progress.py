"""From trial to trial: how many were grasped, and when the next one begins by itself."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app.state import SessionState
from backend.snapshot import Snapshot

WAIT_S = 4.0
"""How long an outcome stays on the page."""


@dataclass(frozen=True)
class Tally:
    """Trials of one kind that have ended since it was chosen."""

    kind: tuple[object, ...] = ()
    ended: int = 0
    grasped: int = 0
    grasped_beside: int = 0
    """By the method compared with."""
    last_run: object = None

    def after(self, state: SessionState) -> Tally:
        """This tally with the outcome in ``state``, if it has one that was not counted yet."""
        restart = state.restart
        kind = (restart.scenario, restart.compare, *sorted(restart.overrides.items()))
        tally = self if kind == self.kind else Tally(kind)
        if state.loading or not state.over or state.started is tally.last_run:
            return tally
        return replace(
            tally,
            ended=tally.ended + 1,
            grasped=tally.grasped + _grasped(state.snapshot),
            grasped_beside=tally.grasped_beside + _grasped(state.beside.snapshot if state.beside else None),
            last_run=state.started,
        )


def _grasped(snapshot: Snapshot | None) -> bool:
    return snapshot is not None and snapshot.outcome is not None and snapshot.outcome.strict


class AutoNext:
    """Says when the next seed is due."""

    def __init__(self) -> None:
        self._run: object = None
        self._due_s = 0.0

    def remaining_s(self, state: SessionState, now_s: float) -> float | None:
        """Seconds until the next trial, 0 or less when it is due; None while none is to come."""
        goes_on = state.view.auto_next and state.status == "running" and not state.pace.paused
        if not goes_on or not state.over or state.loading:
            self._run = None
            return None
        if self._run is not state.started:
            self._run, self._due_s = state.started, now_s + WAIT_S
        return self._due_s - now_s
