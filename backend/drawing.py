"""Drawing: what chance decides of a trial, from its seed."""

import zlib

import numpy as np

from backend.kinematics import load_kinematics
from backend.objects import load_object
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
    kinematics = load_kinematics(scenario.robot)
    home = np.array(kinematics.description.home_rad)
    return scenario.task.draw(rng, load_object(scenario.object), kinematics.spheres_world(home))
