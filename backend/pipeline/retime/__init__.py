"""retime: a path -> the fastest trajectory along it from the arm's current velocity."""

from backend.pipeline.retime.direct import least_s
from backend.pipeline.retime.limits import JointLimits
from backend.pipeline.retime.retime import retime
from backend.pipeline.retime.stop import stop

__all__ = ["JointLimits", "least_s", "retime", "stop"]
