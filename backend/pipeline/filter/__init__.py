"""filter: Candidates -> Shortlist. One file per way to rank."""

from backend.methods.method import FilterConfig, IkFilter, MotionAware, RandomFilter, Reachability, ReachabilityMotion
from backend.pipeline.filter.ik import shortlist_by_ik
from backend.pipeline.filter.known import Known, known_to
from backend.pipeline.filter.motion_aware import shortlist_by_motion
from backend.pipeline.filter.random import shortlist_random
from backend.pipeline.filter.ranking import RankContext
from backend.pipeline.filter.reachability import shortlist_by_reachability
from backend.pipeline.filter.reachability_motion import shortlist_by_both
from backend.pipeline.values import Candidates, Shortlist

__all__ = ["Known", "RankContext", "known_to", "shortlist"]


def shortlist(config: FilterConfig, candidates: Candidates, context: RankContext) -> Shortlist:
    """Rank ``candidates`` as ``config`` says."""
    match config:
        case IkFilter():
            return shortlist_by_ik(config, candidates, context)
        case RandomFilter():
            return shortlist_random(config, candidates, context)
        case Reachability():
            return shortlist_by_reachability(config, candidates, context)
        case MotionAware():
            return shortlist_by_motion(config, candidates, context)
        case ReachabilityMotion():
            return shortlist_by_both(config, candidates, context)
