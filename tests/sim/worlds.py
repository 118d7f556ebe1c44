"""Worlds for tests: one trial's beginning, and an arm that stands still in it."""

import numpy as np

from backend.kinematics import load_kinematics
from backend.objects import load_object
from backend.robots.models import load_model
from backend.scenario import Scenario, load_scenario
from backend.sim.world import World


def world_of(scenario: str | Scenario, object_name: str, seed: int = 3) -> World:
    """The world of a scenario, by name or as it is, with another object."""
    chosen = load_scenario(scenario) if isinstance(scenario, str) else scenario
    model = load_model(chosen.robot)
    home = np.array(model.description.home_rad)
    arm = load_kinematics(chosen.robot).spheres_world(home)
    setup = chosen.task.draw(np.random.default_rng(seed), load_object(object_name), arm)
    return World(model, object_name, setup)


def standing(world: World) -> tuple[list[float], list[float]]:
    """(q, qd) of an arm that stays at home."""
    home = list(world.model.description.home_rad)
    return home, [0.0] * len(home)
