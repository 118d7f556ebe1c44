"""What filters are asked in tests: the UR5 at home, nothing around it."""

import numpy as np

from backend.kinematics import load_kinematics
from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import PreparedGrasps
from backend.knowledge.reachability import load_reachability
from backend.pipeline.filter import Known, RankContext
from backend.pipeline.filter.variety import alike
from backend.pipeline.values import PlanarMotion
from backend.sim.planning_scene import PlanningScene

OBJECT = "tomato_soup_can"
"""Whose grasps are ranked."""


def context_of(
    held: int | None,
    put_off: frozenset[int],
    in_motion: PreparedGrasps | None = None,
    motion: PlanarMotion | None = None,
) -> RankContext:
    """Knows the field of reach, and of motion what it is given."""
    kinematics, grasps = load_kinematics("ur5_robotiq"), load_grasps("ur5_robotiq", OBJECT)
    return RankContext(
        kinematics=kinematics,
        scene=PlanningScene(kinematics),
        q=np.array(kinematics.description.home_rad),
        held=held,
        put_off=put_off,
        lift_m=0.1,
        rng=np.random.default_rng(0),
        known=Known(alike(grasps.Ts_object_grasp), load_reachability("ur5_robotiq"), in_motion),
        motion=motion,
    )
