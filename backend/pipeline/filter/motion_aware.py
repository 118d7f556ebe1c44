"""Motion-aware quality: keep the grasps likeliest to hold while the object moves as predicted."""

from backend.methods.method import MotionAware
from backend.pipeline.filter.ranking import PUT_OFF, RankContext
from backend.pipeline.values import Candidates, Shortlist

OTHERS_HOLD_BETTER = "others hold better in this motion"


def shortlist_by_motion(config: MotionAware, candidates: Candidates, context: RankContext) -> Shortlist:
    """Score by the probability to hold in the motion predicted for the approach; reachability is not asked.

    The grasp the arm is moving to comes first.
    """
    assert context.in_motion is not None and context.motion is not None, "the cycle loads the model where it is used"
    quality = context.in_motion.about(context.motion.speed_mps, context.motion.direction_rad)
    rejected = dict.fromkeys(sorted(context.put_off), PUT_OFF)
    left = set(range(len(candidates.quality))) - set(rejected)
    ranked = sorted(left, key=lambda i: (i != context.held, -quality[i], i))
    rejected |= dict.fromkeys(ranked[config.keep :], OTHERS_HOLD_BETTER)
    return Shortlist(candidates, tuple(ranked[: config.keep]), quality, rejected, motion_quality=quality)
