"""TASKS: the paper's seven, each of which draws trials from a seed."""

from typing import Annotated

from pydantic import Field

from backend.tasks.belt import BeltTask
from backend.tasks.circular import Circular
from backend.tasks.linear import Linear
from backend.tasks.linear_obstacles import LinearObstacles
from backend.tasks.linear_slab import LinearSlab
from backend.tasks.linear_varying import LinearVarying
from backend.tasks.linear_z import LinearZ
from backend.tasks.setup import TrialSetup
from backend.tasks.sinusoidal import Sinusoidal

Task = Annotated[
    Linear | LinearObstacles | LinearSlab | LinearZ | LinearVarying | Circular | Sinusoidal,
    Field(discriminator="kind"),
]

TASKS: dict[str, type[BeltTask]] = {
    "linear": Linear,
    "linear_obstacles": LinearObstacles,
    "linear_slab": LinearSlab,
    "linear_z": LinearZ,
    "linear_varying": LinearVarying,
    "circular": Circular,
    "sinusoidal": Sinusoidal,
}

__all__ = ["TASKS", "BeltTask", "Task", "TrialSetup"]
