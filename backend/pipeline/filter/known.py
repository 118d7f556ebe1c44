"""Known: what filters know of a database's grasps beforehand; loaded once, for those that ask."""

from dataclasses import dataclass

from backend.knowledge.grasps import GraspDatabase
from backend.knowledge.motion_aware import PreparedGrasps, load_motion_aware
from backend.knowledge.reachability import ReachabilityField, load_reachability
from backend.methods.method import FilterConfig, MotionAware, Reachability, ReachabilityMotion
from backend.pipeline.filter.variety import Alike, alike


@dataclass(frozen=True, eq=False)
class Known:
    """The same through a whole trial."""

    alike: Alike
    """Which grasps are alike."""
    reachability: ReachabilityField | None = None
    """For the methods that rank with it."""
    in_motion: PreparedGrasps | None = None
    """The grasps, whose quality in motion is asked for; for the methods that rank with it."""


def known_to(config: FilterConfig, grasps: GraspDatabase) -> Known:
    """What this filter needs to know; errors as ``load_reachability`` and ``load_motion_aware``."""
    field = in_motion = None
    if isinstance(config, Reachability | ReachabilityMotion):
        field = load_reachability(grasps.robot)
    if isinstance(config, MotionAware | ReachabilityMotion):
        in_motion = load_motion_aware(grasps.robot, grasps.object).over(grasps.Ts_object_grasp)
    return Known(alike(grasps.Ts_object_grasp), field, in_motion)
