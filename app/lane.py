"""Lane: one episode, how far it has come, and what of it has been reported."""

from __future__ import annotations

from dataclasses import replace

from app.engine import Engine, Running
from app.reports import Sight, Traces, slim
from backend.events import WorldEvent
from backend.pipeline.values import CycleResult


class Lane:
    """Begins at the first tick; two lanes that are advanced together are in step."""

    def __init__(self, episode: Running, engine: Engine) -> None:
        self.episode = episode
        self._engine = engine
        self._ticks = episode.run()
        self.last = next(self._ticks)
        """The newest tick."""
        self._reported_cycle = -1

    @property
    def over(self) -> bool:
        return self.last.outcome is not None

    def apply(self, event: WorldEvent) -> None:
        """Edit the trial, and let the newest tick show it."""
        self.episode.apply(event)
        self.last = self.episode.edited(self.last)

    def advance(self) -> None:
        """One tick; what is over stays as it is."""
        if not self.over:
            self.last = next(self._ticks)

    def news(self) -> Sight:
        """The newest tick, with its cycle and traces only if that has not been reported yet."""
        cycle = self.last.cycle
        if cycle is None or cycle.number == self._reported_cycle:
            return Sight(replace(self.last, cycle=None), None)
        self._reported_cycle = cycle.number
        return Sight(replace(self.last, cycle=slim(cycle)), self._traces(cycle))

    def _traces(self, cycle: CycleResult) -> Traces:
        paths = (cycle.plan.path if cycle.plan else None, cycle.seed_path)
        robot = self.episode.scene.robot
        plan, seed = (None if path is None else self._engine.tcp_trace(robot, path.waypoints) for path in paths)
        return Traces(plan, seed)
