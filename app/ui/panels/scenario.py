"""Scenario: which problem is shown, and its belt. Every change says whether it restarted the trial."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

import viser

from app.commands import ApplyEvent
from app.ui.desk import Answer, Desk, checked
from app.ui.panels.panel import View
from app.ui.progress import AutoNext
from app.ui.words import note
from backend.errors import InvalidInputError
from backend.events import SetBeltRate

SETTLE_S = 0.6
"""Typed numbers act when the typing has stopped for so long."""
LIVE_RATE = 4.0
"""Largest live factor of the belt's speed."""
CM_PER_M = 100.0


class ScenarioPanel:
    """What is tried."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, auto_next: AutoNext) -> None:
        self._desk = desk
        engine, state = desk.session.engine, desk.session.state
        with gui.add_folder("Scenario"):
            names = engine.scenario_names()
            self._scenario = gui.add_dropdown("Scenario", names, initial_value=state.info.scenario)
            self._object = gui.add_dropdown("Object", engine.object_names(), initial_value=state.info.object)
            self._method = gui.add_dropdown("Method", engine.method_names(), initial_value=state.info.method)
            self._seed = gui.add_number("Seed", state.restart.seed, step=1)
        with gui.add_folder("Belt"):
            self._speed = gui.add_slider("Speed cm/s", -20.0, 20.0, 0.1, 0.0)
            self._factor = gui.add_slider("Speed factor", -LIVE_RATE, LIVE_RATE, 0.1, 1.0, visible=False)
            self._direction = gui.add_button_group("Direction", ("Forth", "Stop", "Back"))
            self._status = gui.add_html("")
        self._scenario.on_update(self._choose("scenario", self.set_scenario))
        self._object.on_update(self._choose("object", lambda name: self.override("object", name)))
        self._method.on_update(self._choose("method", lambda name: self.override("method", name)))
        self._seed.on_update(self._choose("seed", self.set_seed, SETTLE_S))
        self._speed.on_update(self._choose("belt", lambda cmps: self.set_belt(cmps / CM_PER_M), 0.2))
        self._factor.on_update(self._choose("belt", self.set_rate, 0.2))
        self._direction.on_click(self._choose("direction", self.set_direction))

    def show(self, view: View) -> None:
        info, mirror = view.state.info, self._desk.mirror
        self._offer_objects(info.object)
        mirror("scenario", self._scenario, info.scenario)
        mirror("object", self._object, info.object)
        mirror("method", self._method, info.method)
        mirror("seed", self._seed, view.state.restart.seed)
        self._show_belt(view)
        self._status.content = note(view.status_line)

    def _offer_objects(self, running: str) -> None:
        """Objects may come and go while the page is open; the one that is tried stays on offer."""
        offered = tuple(dict.fromkeys((*self._desk.session.engine.object_names(), running)))
        if offered != self._object.options:
            self._object.options = offered

    def set_scenario(self, name: str) -> Answer:
        """Restart with another scenario as its file has it."""
        self._desk.restart(scenario=name)
        return f"Restarted with scenario {name}."

    def override(self, path: str, value: str) -> Answer:
        """Restart with one value of the scenario changed."""
        self._desk.restart(overrides={path: value})
        return f"Restarted with {path} {value}."

    def set_seed(self, seed: int) -> Answer:
        """Restart with another seed."""
        self._desk.restart(seed=seed)
        return f"Restarted with seed {seed}."

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
        snapshot = self._desk.session.state.snapshot
        pace = abs(snapshot.belt_rate) if snapshot and abs(snapshot.belt_rate) > 0.05 else 1.0
        rates = {"Forth": pace, "Stop": 0.0, "Back": -pace}
        if label not in rates:
            raise InvalidInputError(f"direction: choose one of {', '.join(rates)} (got {label!r})")
        self.set_rate(rates[label])
        done = {"Forth": "runs forth", "Stop": "stopped", "Back": "runs back"}[label]
        return f"Belt {done} in the running trial."

    def _is_running(self) -> bool:
        state = self._desk.session.state
        return state.snapshot is not None and state.snapshot.outcome is None and not state.loading

    def _show_belt(self, view: View) -> None:
        speed_mps, snapshot = view.state.info.speed_mps, view.state.snapshot
        self._speed.visible = speed_mps is not None
        self._factor.visible = speed_mps is None
        if snapshot is None:
            return
        if speed_mps is None:
            self._desk.mirror("belt", self._factor, round(snapshot.belt_rate, 1))
        else:
            self._desk.mirror("belt", self._speed, round(CM_PER_M * speed_mps * snapshot.belt_rate, 1))

    def _choose(
        self, key: str, act: Callable[[Any], Answer], after_s: float = 0.0
    ) -> Callable[[Any], Coroutine[None, None, None]]:
        """A callback that leaves the wish to do ``act`` with the widget's value.

        It is a coroutine because viser calls those at once, and not some time later in a pool of threads.
        """

        async def on_event(event: viser.GuiEvent[Any]) -> None:
            if event.client is not None:  # None: set by ``show``
                value = event.target.value
                self._desk.wish(key, lambda: act(value), event.client, after_s)

        return on_event
