"""R+M: the best by reachability and the best by motion-aware quality, together."""

from dataclasses import replace
from itertools import chain, zip_longest

import numpy as np

from backend.methods.method import MotionAware, Reachability, ReachabilityMotion
from backend.pipeline.filter.motion_aware import shortlist_by_motion
from backend.pipeline.filter.ranking import PUT_OFF, RankContext
from backend.pipeline.filter.reachability import shortlist_by_reachability
from backend.pipeline.reasons import Reasons
from backend.pipeline.values import Candidates, Shortlist


def shortlist_by_both(config: ReachabilityMotion, candidates: Candidates, context: RankContext) -> Shortlist:
    """The two shortlists in turn, each grasp once.

    As in the paper the better half by motion may be out of reach; IK finds that out. The grasp the arm is moving to
    comes first while it is reachable. There is no one score to rank by, so ``score`` is NaN.
    """
    by_reach = shortlist_by_reachability(Reachability(keep=config.keep_each, varied=config.varied), candidates, context)
    unheld = replace(context, held=None)
    by_motion = shortlist_by_motion(MotionAware(keep=config.keep_each, varied=config.varied), candidates, unheld)
    in_turn = chain.from_iterable(zip_longest(by_reach.kept, by_motion.kept))
    kept = dict.fromkeys(i for i in in_turn if i is not None)
    out = [i for i in by_reach.rejected if i not in kept]
    rejected = Reasons(out, lambda i: _why(by_reach.rejected[i], by_motion.rejected[i]))
    return Shortlist(
        candidates,
        tuple(kept),
        np.full(len(candidates.quality), np.nan),
        rejected,
        reachability_m=by_reach.reachability_m,
        motion_quality=by_motion.motion_quality,
    )


def _why(of_reach: str, of_motion: str) -> str:
    """Either list's reason, or the one they share."""
    return of_motion if of_motion == PUT_OFF else f"{of_reach}; {of_motion}"
