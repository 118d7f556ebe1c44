"""METHODS: every named way to grasp, by name."""

from backend.methods.method import (
    IkFilter,
    LastPose,
    Method,
    MotionAware,
    RandomFilter,
    Reachability,
    ReachabilityMotion,
    RrtConnect,
)

METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(name="ik", title="IK-filtered grasps", filter=IkFilter()),
        Method(name="ours_rm", title="Ours (R+M)", filter=ReachabilityMotion()),
        Method(name="reachability", title="Ours (Reachability)", filter=Reachability()),
        Method(name="motion_aware", title="Ours (Motion-aware)", filter=MotionAware()),
        Method(name="baseline", title="Baseline (10 random grasps)", filter=RandomFilter()),
        Method(
            name="no_seeding",
            title="No trajectory seeding",
            filter=ReachabilityMotion(),
            planner=RrtConnect(seeded=False),
        ),
        Method(name="no_prediction", title="No prediction", filter=ReachabilityMotion(), predictor=LastPose()),
    )
}

__all__ = ["METHODS", "Method"]
