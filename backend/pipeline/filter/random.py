"""Random grasps: the paper's baseline."""

import numpy as np

from backend.methods.method import RandomFilter
from backend.pipeline.filter.ranking import PUT_OFF, RankContext
from backend.pipeline.values import Candidates, Shortlist


def shortlist_random(config: RandomFilter, candidates: Candidates, context: RankContext) -> Shortlist:
    """Draw ``keep`` grasps; the one the arm is moving to stays among them."""
    n = len(candidates.quality)
    order = [int(i) for i in context.rng.permutation(n) if int(i) not in context.put_off]
    if context.held is not None:
        order.remove(context.held)
        order.insert(0, context.held)
    kept = tuple(order[: config.keep])
    rejected = {i: "not drawn" for i in order[config.keep :]} | dict.fromkeys(context.put_off, PUT_OFF)
    return Shortlist(candidates, kept, np.full(n, np.nan), rejected)
