"""execute: Trajectory -> joint targets; approach, close, lift."""

from backend.pipeline.execute.approach import RIDE_S, Approach, ApproachRequest, correct_approach, plan_approach
from backend.pipeline.execute.blend import SHORTEST_LIFT_S, lift_way
from backend.pipeline.execute.can_grasp import can_grasp
from backend.pipeline.execute.cartesian import ArmState
from backend.pipeline.execute.closing import CLOSE_AT_MOST_S, Closing
from backend.pipeline.execute.executor import Executor
from backend.pipeline.execute.lift import plan_lift

__all__ = [
    "CLOSE_AT_MOST_S",
    "RIDE_S",
    "SHORTEST_LIFT_S",
    "Approach",
    "ApproachRequest",
    "ArmState",
    "Closing",
    "Executor",
    "can_grasp",
    "correct_approach",
    "lift_way",
    "plan_approach",
    "plan_lift",
]
