"""Contenders: two methods at the same trial, and what is to be said of each."""

from __future__ import annotations

from dataclasses import dataclass

from app.engine import Keepsake
from app.state import SessionState
from app.ui.palette import BRAND, Rgb
from app.ui.words import PHASES, outcome_color
from backend.methods import METHODS
from backend.pipeline.values import FailureReason, Outcome, Phase

NOTHING = "nothing"
"""What is chosen where nothing is compared."""
ENDS: dict[FailureReason, str] = {
    "never_reachable": "never within reach",
    "no_ik": "no joint angles",
    "no_plan": "no way found",
    "approach_missed": "missed",
    "dropped": "dropped",
    "knocked_obstacle": "obstacle knocked",
    "belt_end": "belt end",
    "object_fell": "object fell",
    "timeout": "time up",
    "error": "broke down",
}


@dataclass(frozen=True)
class Contender:
    """One of two."""

    method: str
    phase: Phase
    outcome: Outcome | None
    lifted_s: float | None
    """Simulated time at which the lift was over, once that is known."""

    @property
    def words(self) -> str:
        """Such as ``ours_rm: lifted after 11.2 s`` or ``baseline: belt end``."""
        return f"{self.method}: {self.state}"

    @property
    def color(self) -> Rgb:
        return BRAND if self.outcome is None else outcome_color(self.outcome)

    @property
    def state(self) -> str:
        """Without the method's name."""
        if self.outcome is None:
            return PHASES[self.phase].lower()
        if self.outcome.strict:
            return "lifted" if self.lifted_s is None else f"lifted after {self.lifted_s:.1f} s"
        return ENDS[self.outcome.reason] if self.outcome.reason else "not grasped"


def contenders(state: SessionState) -> tuple[Contender, ...]:
    """The running trial's, then the one beside it; none while nothing is compared."""
    first, second = state.snapshot, state.beside
    if first is None or second is None or state.started is None:
        return ()
    other = second.snapshot
    return (
        Contender(method_name(state), first.phase, first.outcome, _lifted_s(state.keepsake)),
        Contender(str(state.started.restart.compare), other.phase, other.outcome, _lifted_s(state.keepsake_beside)),
    )


def method_name(state: SessionState) -> str:
    """What the running trial's method is called, and whether it is not as it is listed."""
    method = state.info.values.method
    return method.name if METHODS.get(method.name) == method else f"{method.name} (edited)"


def _lifted_s(left: Keepsake | None) -> float | None:
    lifted_s = None if left is None else left.record.get("lift_end_s")
    return lifted_s if isinstance(lifted_s, float) else None
