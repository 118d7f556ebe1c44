"""plan: a picked grasp's joint goals -> a path that touches nothing."""

from backend.methods.method import PlannerConfig
from backend.pipeline.plan.chomp import ChompPlanner
from backend.pipeline.plan.fast import FastPlanner
from backend.pipeline.plan.planner import Planner
from backend.pipeline.plan.prm import PrmPlanner
from backend.pipeline.plan.rrt_connect import RrtConnectPlanner

__all__ = ["Planner", "make_planner"]


def make_planner(config: PlannerConfig) -> Planner:
    """The planner that a method's configuration asks for."""
    match config.kind:
        case "rrt_connect":
            return RrtConnectPlanner(config)
        case "prm":
            return PrmPlanner(config)
        case "chomp":
            return ChompPlanner(config)
        case "fast":
            return FastPlanner(config)
