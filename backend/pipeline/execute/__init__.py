"""execute: Trajectory -> joint targets; approach, close, lift."""

from backend.pipeline.execute.approach import Approach, ApproachRequest, correct_approach, plan_approach
from backend.pipeline.execute.can_grasp import can_grasp
from backend.pipeline.execute.cartesian import ArmState
from backend.pipeline.execute.executor import CLOSE_AT_MOST_S, Executor
from backend.pipeline.execute.lift import plan_lift

__all__ = [
    "CLOSE_AT_MOST_S",
    "Approach",
    "ApproachRequest",
    "ArmState",
    "Executor",
    "can_grasp",
    "correct_approach",
    "plan_approach",
    "plan_lift",
]
