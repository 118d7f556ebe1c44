"""Drawing: what chance decides of a trial, from its seed."""

import zlib

import numpy as np

from backend import kinematics
from backend.errors import InvalidInputError
from backend.objects import load_object
from backend.pose import Array
from backend.scenario import Scenario
from backend.tasks.clearance import can_begin
from backend.tasks.setup import TrialSetup
from backend.tasks.start import Start, setup_of, start_of


def generators(scenario: Scenario, seed: int) -> list[np.random.Generator]:
    """Independent generators for task, sensing and cycle; they depend on nothing but robot, task, object and seed."""
    names = (scenario.robot, scenario.task.kind, scenario.object)
    entropy = [seed, *(zlib.crc32(name.encode()) for name in names)]
    return [np.random.default_rng(child) for child in np.random.SeedSequence(entropy).spawn(3)]


def setup_of_seed(scenario: Scenario, seed: int) -> TrialSetup:
    """How the trial of that seed begins; errors as ``setup_by``."""
    return setup_by(scenario, generators(scenario, seed)[0])


def setup_by(scenario: Scenario, rng: np.random.Generator) -> TrialSetup:
    """How a trial begins: as the scenario says, or else by a generator of its own.

    A start that says what would be drawn is that, to the last bit. Raises ``InvalidInputError`` when no belt is free,
    or no trial can begin as the scenario says.
    """
    start = scenario.start
    if start is None:
        return _drawn(scenario, rng)
    try:
        drawn = _drawn(scenario, rng)
    except InvalidInputError:
        drawn = None
    if drawn is not None and start_of(drawn) == start:
        return drawn
    try:
        return placed_setup(start, scenario.robot, scenario.task.kind, scenario.object)
    except InvalidInputError as error:
        raise InvalidInputError(f"start: {error}") from None


def placed_setup(start: Start, robot: str, task: str, object: str) -> TrialSetup:
    """How a trial begins by a start in which nothing is wrong; raises ``InvalidInputError`` when none can."""
    setup = setup_of(start, task, object)
    if can_begin(setup, load_object(object), arm_at_home(robot)):
        return setup
    raise InvalidInputError("object, tray or slab would start in the arm or run into its base")


def arm_at_home(robot: str) -> Array:
    """(n, 4) the collision spheres of the arm as every trial finds it: centres in the world and radii, m."""
    arm = kinematics.load_kinematics(robot)
    return arm.spheres_world(np.array(arm.description.home_rad))


def _drawn(scenario: Scenario, rng: np.random.Generator) -> TrialSetup:
    return scenario.task.draw(rng, load_object(scenario.object), arm_at_home(scenario.robot))
