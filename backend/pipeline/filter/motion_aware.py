"""Motion-aware quality: keep the grasps likeliest to hold while the object moves as predicted."""

import numpy as np

from backend.methods.method import MotionAware
from backend.pipeline.filter.ranking import PUT_OFF, RankContext, best_first
from backend.pipeline.reasons import Reasons
from backend.pipeline.values import Candidates, Shortlist

OTHERS_HOLD_BETTER = "others hold better in this motion"


def shortlist_by_motion(config: MotionAware, candidates: Candidates, context: RankContext) -> Shortlist:
    """Score by the probability to hold in the motion predicted for the approach; reachability is not asked.

    The grasp the arm is moving to comes first.
    """
    assert context.in_motion is not None and context.motion is not None, "the cycle loads the model where it is used"
    quality = context.in_motion.about(context.motion.speed_mps, context.motion.direction_rad)
    put_off = context.put_off
    left = np.ones(len(candidates.quality), dtype=np.bool_)
    left[list(put_off)] = False
    ranked = best_first(quality, left, context.held)
    out = [*sorted(put_off), *ranked[config.keep :]]
    rejected = Reasons(out, lambda i: PUT_OFF if i in put_off else OTHERS_HOLD_BETTER)
    return Shortlist(candidates, tuple(ranked[: config.keep]), quality, rejected, motion_quality=quality)
