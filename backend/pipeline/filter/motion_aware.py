"""Motion-aware quality: keep the grasps likeliest to hold while the object moves as predicted."""

import numpy as np

from backend.methods.method import MotionAware
from backend.pipeline.filter.ranking import PUT_OFF, RankContext, best_first
from backend.pipeline.filter.variety import varied
from backend.pipeline.reasons import Reasons
from backend.pipeline.values import Candidates, Shortlist

OTHERS_HOLD_BETTER = "others hold better in this motion"
LIKE_A_KEPT_ONE = "much like one that is kept"


def shortlist_by_motion(config: MotionAware, candidates: Candidates, context: RankContext) -> Shortlist:
    """Score by the probability to hold in the motion predicted for the approach; reachability is not asked.

    The grasp the arm is moving to comes first.
    """
    assert context.known.in_motion is not None and context.motion is not None, (
        "the cycle loads the model where it is used"
    )
    quality = context.known.in_motion.about(context.motion.speed_mps, context.motion.direction_rad)
    put_off = context.put_off
    left = np.ones(len(candidates.quality), dtype=np.bool_)
    left[list(put_off)] = False
    ranked = best_first(quality, left, context.held)
    kept, passed = varied(ranked, config.keep, context.known.alike if config.varied else None)

    def why(i: int) -> str:
        if i in put_off:
            return PUT_OFF
        return LIKE_A_KEPT_ONE if i in passed else OTHERS_HOLD_BETTER

    rejected = Reasons([*sorted(put_off), *(i for i in ranked if i not in kept)], why)
    return Shortlist(candidates, tuple(kept), quality, rejected, motion_quality=quality)
