"""Belt: its speed and direction, set in the running trial and recorded with it."""

from __future__ import annotations

import viser

from app.commands import ApplyEvent
from app.state import SessionState
from app.ui.desk import Answer, Desk, checked
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from backend.errors import InvalidInputError
from backend.events import SetBeltRate

BELT_RATE = 1.0
"""Of a trial nobody has edited."""
LIVE_RATE = 4.0
"""Largest live factor of the belt's speed."""
CM_PER_M = 100.0
SETTLE_S = 0.2


class BeltPanel:
    """What acts at once."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        with gui.add_folder("Belt (acts at once)"):
            self._speed = gui.add_slider(
                "Belt, cm/s", -20.0, 20.0, 0.1, 0.0, hint="Up to 4 times the scenario's; beyond, the trial restarts"
            )
            self._factor = gui.add_slider(
                "Belt factor", -LIVE_RATE, LIVE_RATE, 0.1, 1.0, visible=False, hint="1 is as the scenario has it"
            )
            self._direction = gui.add_button_group("Direction", ("Forth", "Stop", "Back"))
        self._speed.on_update(choosing(desk, "belt", lambda cmps: self.set_belt(cmps / CM_PER_M), SETTLE_S))
        self._factor.on_update(choosing(desk, "belt", self.set_rate, SETTLE_S))
        self._direction.on_click(choosing(desk, "direction", self.set_direction))

    def show(self, view: View) -> None:
        speed_mps, rate = view.state.info.speed_mps, rate_asked_for(view.state)
        self._speed.visible = speed_mps is not None
        self._factor.visible = speed_mps is None
        if rate is None:
            return
        if speed_mps is None:
            self._desk.mirror("belt", self._factor, round(rate, 1))
        else:
            self._desk.mirror("belt", self._speed, round(CM_PER_M * speed_mps * rate, 1))

    def set_belt(self, speed_mps: float) -> Answer:
        """Change the belt of the running trial where that is possible, else restart with another speed."""
        info = self._desk.session.state.info
        if info.speed_mps is None or info.speed_path is None:
            raise InvalidInputError(f"The task {info.task} has no single belt speed: use the speed factor.")
        rate = speed_mps / info.speed_mps
        if abs(rate) <= LIVE_RATE and self._is_running():
            self.set_rate(rate)
            return f"Belt set to {CM_PER_M * speed_mps:.1f} cm/s in the running trial."
        self._desk.restart(overrides={info.speed_path: abs(speed_mps)})
        if speed_mps < 0.0:
            self.set_rate(-1.0)
        return f"Restarted with belt speed {CM_PER_M * speed_mps:.1f} cm/s."

    def set_rate(self, rate: float) -> Answer:
        """Scale the belt of the running trial."""
        self._desk.send(ApplyEvent(event=checked(SetBeltRate, rate=rate)))
        return f"Belt at {rate:.1f} times its speed in the running trial."

    def set_direction(self, label: str) -> Answer:
        """Run the belt forward or backward at its speed, or stop it."""
        rate = abs(rate_asked_for(self._desk.session.state) or 0.0)
        pace = rate if rate > 0.05 else 1.0
        rates = {"Forth": pace, "Stop": 0.0, "Back": -pace}
        if label not in rates:
            raise InvalidInputError(f"direction: choose one of {', '.join(rates)} (got {label!r})")
        self.set_rate(rates[label])
        done = {"Forth": "runs forth", "Stop": "stopped", "Back": "runs back"}[label]
        return f"Belt {done} in the running trial."

    def _is_running(self) -> bool:
        state = self._desk.session.state
        return state.snapshot is not None and not state.over and not state.loading


def rate_asked_for(state: SessionState) -> float | None:
    """What the belt runs at, or is on its way to: after an edit, once time goes on. None before a trial's start."""
    if state.newest is None:
        return None
    edits = sorted((*state.info.values.events, *state.events), key=lambda timed: timed.tick)
    rates = [e.event.rate for e in edits if e.tick <= state.newest.tick and isinstance(e.event, SetBeltRate)]
    return rates[-1] if rates else BELT_RATE
