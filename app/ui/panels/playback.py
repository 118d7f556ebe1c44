"""Playback: play, pause, step, reset, pace; also by keys and from the command palette."""

from __future__ import annotations

from collections.abc import Callable

import viser

from app.commands import SPEEDS, LookBack, SetPaused, SetSpeed, StepOnce
from app.state import SessionState
from app.ui.desk import Answer, Desk, checked
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.words import note
from backend.errors import lookup

FASTEST = "max"
TICK_S = 1 / 30


def speed_label(speed: float | None) -> str:
    """As in the drop-down: ``1/8`` .. ``8``, ``max``."""
    if speed is None:
        return FASTEST
    return f"{speed:g}" if speed >= 1.0 else f"1/{1.0 / speed:g}"


LABELS: dict[str, float | None] = {speed_label(speed): speed for speed in (*SPEEDS, None)}


class PlaybackPanel:
    """How time passes."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        self._actions: dict[str, Callable[[], Answer]] = {
            "Play": self.toggle,
            "Pause": self.toggle,
            "Step": self.step,
            "Reset": self.reset,
            "Next seed": self.next_seed,
        }
        with gui.add_folder("Playback"):
            self._time = gui.add_button_group("Time", ("Pause", "Step"), hint="Space; the right arrow is one tick")
            self._trial = gui.add_button_group("Trial", ("Reset", "Next seed"), hint="R the same again, N the next")
            self._speed = gui.add_dropdown(
                "Speed", tuple(LABELS), initial_value=speed_label(1.0), hint="Simulated seconds per second"
            )
            self._auto = gui.add_checkbox(
                "Auto next", desk.session.state.view.auto_next, hint="Go on with the next seed 4 s after an outcome"
            )
            self._status = gui.add_html("")
        self._time.on_click(self._on_button)
        self._trial.on_click(self._on_button)
        self._speed.on_update(self._on_speed)
        self._auto.on_update(choosing(desk, "auto", lambda on: desk.change_view(auto_next=on)))
        self._add_keys(gui)

    def show(self, view: View) -> None:
        still = view.live.pace.paused or _at_rest(view.live)
        self._time.options = ("Play" if still else "Pause", "Step")
        self._status.content = note(view.status_line) if view.status_line else ""
        self._desk.mirror("auto", self._auto, view.state.view.auto_next)
        label = speed_label(view.state.pace.speed)
        if label in LABELS:
            self._desk.mirror("speed", self._speed, label)

    def press(self, label: str) -> Answer:
        """Raises ``NotFoundError`` for a button that is not there."""
        return lookup("button", label, self._actions)()

    def toggle(self) -> Answer:
        """Pause or go on; at the end, where nothing else comes, the same trial from its start."""
        state = self._desk.session.state
        over = _at_rest(state)
        if not over or state.pace.paused:
            self._desk.send(SetPaused(paused=not state.pace.paused))
        return self.reset() if over else None

    def step(self) -> Answer:
        """One tick; of those there were, while somebody looks back."""
        looked_at = self._desk.session.state.looked_at
        self._desk.send(LookBack(t_s=looked_at.t_s + TICK_S) if looked_at else StepOnce())
        return None

    def step_back(self) -> Answer:
        """Show the tick before the one shown."""
        snapshot = self._desk.session.state.shown.newest
        if snapshot is not None:
            self._desk.send(LookBack(t_s=max(0.0, snapshot.t_s - TICK_S)))
        return None

    def reset(self) -> Answer:
        """The same trial from its start, as it was asked for."""
        again = self._desk.restart()
        edits = f" and the {len(again.events)} edits it came with" if again.events else ""
        return f"Trial restarted with seed {again.seed}{edits}."

    def next_seed(self) -> Answer:
        """The same problem with the next seed."""
        seed = self._desk.session.state.restart.seed
        return f"Trial restarted with seed {self._desk.restart(seed=seed + 1).seed}."

    def set_speed(self, label: str) -> Answer:
        """Raises ``NotFoundError`` for a label that is not offered."""
        self._desk.send(checked(SetSpeed, speed=lookup("speed", label, LABELS)))
        return None

    async def _on_button(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        label = event.target.value
        self._desk.wish("button", lambda: self.press(label), event.client)

    async def _on_speed(self, event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
        if event.client is None:
            return
        label = event.target.value
        self._desk.wish("speed", lambda: self.set_speed(label), event.client)

    def _add_keys(self, gui: viser.GuiApi) -> None:
        """The arrows are T and B as well, by the page's own script: viser turns the camera with them."""

        def register(command: viser.CommandHandle, key: str, act: Callable[[], Answer]) -> None:
            command.on_trigger(lambda event: self._desk.wish(key, act, event.client))

        register(gui.add_command("Play or pause", hotkey="space"), "key space", self.toggle)
        register(gui.add_command("One tick", hotkey="T"), "key T", self.step)
        register(gui.add_command("One tick back", hotkey="B"), "key B", self.step_back)
        register(gui.add_command("Restart the trial", hotkey="R"), "key R", self.reset)
        register(gui.add_command("Next seed", hotkey="N"), "key N", self.next_seed)


def _at_rest(state: SessionState) -> bool:
    """Whether the trial has ended, is looked at in its last moment, and no other follows by itself."""
    return state.over and state.looked_at is None and not state.loading and not state.view.auto_next
