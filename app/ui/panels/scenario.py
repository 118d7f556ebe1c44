"""Scenario: which problem is shown. Every change restarts the trial, and says so."""

from __future__ import annotations

from typing import Any

import viser

from app.ui.desk import Answer, Desk
from app.ui.panels.choice import SETTLE_S, choosing
from app.ui.panels.panel import View


class ScenarioPanel:
    """What is tried."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        engine, state = desk.session.engine, desk.session.state
        with gui.add_folder("Problem (restarts)"):
            self._scenario = gui.add_dropdown(
                "Scenario",
                engine.scenario_names(),
                initial_value=state.info.scenario,
                hint="Robot and task, as a file has them; what was set below goes",
            )
            self._object = gui.add_dropdown(
                "Object", engine.object_names(), initial_value=state.info.object, hint="What is to be grasped"
            )
            self._seed = gui.add_number(
                "Seed", state.restart.seed, step=1, hint="Decides all that is drawn: the same seed, the same trial"
            )
        self._scenario.on_update(choosing(desk, "scenario", self.set_scenario))
        self._object.on_update(choosing(desk, "object", self.set_object))
        self._seed.on_update(choosing(desk, "seed", self.set_seed, SETTLE_S))

    def show(self, view: View) -> None:
        info, mirror, engine = view.state.info, self._desk.mirror, self._desk.session.engine
        _offer(self._scenario, engine.scenario_names(), info.scenario)
        _offer(self._object, engine.object_names(), info.object)
        mirror("scenario", self._scenario, info.scenario)
        mirror("object", self._object, info.object)
        mirror("seed", self._seed, view.state.restart.seed)

    def set_scenario(self, name: str) -> Answer:
        """Restart with another scenario as its file has it."""
        self._desk.restart(scenario=name)
        return f"Restarted with scenario {name}."

    def set_object(self, name: str) -> Answer:
        """Restart with another object."""
        self._desk.restart(overrides={"object": name})
        return f"Restarted with object {name}."

    def set_seed(self, seed: int) -> Answer:
        """Restart with another seed."""
        self._desk.restart(seed=seed)
        return f"Restarted with seed {seed}."


def _offer(dropdown: Any, names: tuple[str, ...], running: str) -> None:
    """Names may come and go while the page is open; the one that is tried stays on offer."""
    offered = tuple(dict.fromkeys((*names, running)))
    if offered != dropdown.options:
        dropdown.options = offered
