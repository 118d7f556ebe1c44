"""Drawing: what chance decides of a trial, from its seed."""

import zlib

import numpy as np

from backend import kinematics
from backend.objects import load_object
from backend.pose import Array
from backend.scenario import Scenario
from backend.tasks.setup import TrialSetup


def generators(scenario: Scenario, seed: int) -> list[np.random.Generator]:
    """Independent generators for task, sensing and cycle; they depend on nothing but robot, task, object and seed."""
    names = (scenario.robot, scenario.task.kind, scenario.object)
    entropy = [seed, *(zlib.crc32(name.encode()) for name in names)]
    return [np.random.default_rng(child) for child in np.random.SeedSequence(entropy).spawn(3)]


def drawn_setup(scenario: Scenario, seed: int) -> TrialSetup:
    """How the trial of that seed begins; raises ``InvalidInputError`` when no belt is free."""
    return drawn_by(scenario, generators(scenario, seed)[0])


def drawn_by(scenario: Scenario, rng: np.random.Generator) -> TrialSetup:
    """How a trial begins, by a generator of its own."""
    return scenario.task.draw(rng, load_object(scenario.object), arm_at_home(scenario.robot))


def arm_at_home(robot: str) -> Array:
    """(n, 4) the collision spheres of the arm as every trial finds it: centres in the world and radii, m."""
    arm = kinematics.load_kinematics(robot)
    return arm.spheres_world(np.array(arm.description.home_rad))
