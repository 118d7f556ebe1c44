"""How the trial of a job begins, without running it."""

from backend.drawing import drawn_setup
from backend.errors import InvalidInputError
from backend.experiments.grid.cells import Job
from backend.experiments.grid.conditions import conditions_of, setup_of
from backend.tasks.setup import TrialSetup


def setup_of_job(job: Job) -> TrialSetup | None:
    """How a trial of a trial set begins; None where that is what the seed draws, to the last bit of it."""
    asked = job.conditions
    if asked is None:
        return None
    try:
        drawn = drawn_setup(job.scenario, job.seed)
    except InvalidInputError:
        return setup_of(asked)
    key = job.key
    return None if conditions_of(key.robot, key.task, key.object, job.seed, drawn) == asked else setup_of(asked)
