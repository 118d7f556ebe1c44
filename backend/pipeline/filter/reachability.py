"""Reachability: keep the grasps that lie furthest inside what the arm can reach."""

import numpy as np

from backend.methods.method import Reachability
from backend.pipeline.filter.ranking import PUT_OFF, RankContext, best_first
from backend.pipeline.filter.variety import varied
from backend.pipeline.reasons import Reasons
from backend.pipeline.values import Candidates, Shortlist


def shortlist_by_reachability(config: Reachability, candidates: Candidates, context: RankContext) -> Shortlist:
    """Score by the arm's own signed distance, in metres, of pregrasp or grasp, whichever is less.

    What is not reachable is out, with its distance including the hand's height as score; the grasp the arm is moving
    to comes first while it is reachable.
    """
    field = context.known.reachability
    assert field is not None, "the cycle loads the field for methods that rank with it"
    n = len(candidates.quality)
    parts = field.parts(np.concatenate([candidates.Ts_world_pregrasp, candidates.Ts_world_grasp]))
    distance = parts.min(axis=1)
    worse = np.minimum(distance[:n], distance[n:])
    score = np.where(worse > 0.0, np.minimum(parts[:n, 0], parts[n:, 0]), worse)
    out, put_off = worse <= 0.0, context.put_off
    out[list(put_off)] = True
    ranked = best_first(score, ~out, context.held)
    kept, passed = varied(ranked, config.keep, context.known.alike if config.varied else None)

    def why(i: int) -> str:
        if i in put_off:
            return PUT_OFF
        if i in passed:
            return "reachable, but much like one that is kept"
        return "reachable, but others lie further inside" if worse[i] > 0.0 else _beyond(distance[i], distance[n + i])

    rejected = Reasons([*np.flatnonzero(out).tolist(), *(i for i in ranked if i not in kept)], why)
    return Shortlist(candidates, tuple(kept), score, rejected, reachability_m=score)


def _beyond(pregrasp_m: float, grasp_m: float) -> str:
    which, beyond_m = ("pregrasp", -pregrasp_m) if pregrasp_m <= grasp_m else ("grasp", -grasp_m)
    return f"{which} out of reach by about {100.0 * beyond_m:.1f} cm"
