"""METHODS: every named way to grasp, by name."""

from backend.methods.method import IkFilter, LastPose, Method, RandomFilter, Reachability, RrtConnect

METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(name="ik", title="IK-filtered grasps", filter=IkFilter()),
        Method(name="reachability", title="Ours (Reachability)", filter=Reachability()),
        Method(name="baseline", title="Baseline (10 random grasps)", filter=RandomFilter()),
        Method(name="no_seeding", title="No trajectory seeding", planner=RrtConnect(seeded=False)),
        Method(name="no_prediction", title="No prediction", predictor=LastPose()),
    )
}

__all__ = ["METHODS", "Method"]
