"""The real engine behind the door of ``app.engine``; heavy parts are imported where they are needed."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np

from app.commands import Restart
from app.engine import Running, TrialInfo, info_of
from app.wanted import read_scenario, scenario_of
from backend.knowledge.reach_profile import ReachProfile, profile_of
from backend.methods import METHODS
from backend.objects import object_names
from backend.pose import Array
from backend.scenario import scenario_names

TRACE_STEP_RAD = 0.08
"""Joint distance between the drawn points of a path."""


class BackendEngine:
    """Scenarios from the project's files, episodes from ``backend.episode``."""

    def scenario_names(self) -> tuple[str, ...]:
        return scenario_names()

    def object_names(self) -> tuple[str, ...]:
        return object_names()

    def method_names(self) -> tuple[str, ...]:
        return tuple(METHODS)

    def describe(self, restart: Restart) -> TrialInfo:
        return info_of(restart.scenario, scenario_of(restart))

    def seed_in(self, name: str, text: str) -> int:
        return read_scenario(text, name).seed

    def make_episode(self, restart: Restart) -> Running:
        from app.live_episode import LiveEpisode

        return LiveEpisode(scenario_of(restart), restart.seed)

    def reach(self, robot: str) -> ReachProfile:
        return _reach(robot)

    def tcp_trace(self, robot: str, waypoints: Array) -> Array:
        from backend.kinematics import load_kinematics

        return load_kinematics(robot).fk_many(_densified(waypoints))[:, :3, 3]


@cache
def _reach(robot: str) -> ReachProfile:
    from backend.knowledge.reachability import load_reachability

    return profile_of(load_reachability(robot))


def _densified(waypoints: Array) -> Array:
    """(m, dof) points on the straight edges between ``waypoints`` (n, dof), ends included."""
    pieces = [waypoints[:1]]
    for a, b in itertools.pairwise(waypoints):
        steps = max(1, int(np.ceil(np.abs(b - a).max() / TRACE_STEP_RAD)))
        pieces.append(a + np.linspace(0.0, 1.0, steps + 1)[1:, None] * (b - a))
    return np.concatenate(pieces)
