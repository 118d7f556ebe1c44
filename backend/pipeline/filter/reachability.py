"""Reachability: keep the grasps that lie furthest inside what the arm can reach."""

import numpy as np

from backend.methods.method import Reachability
from backend.pipeline.filter.ranking import PUT_OFF, RankContext
from backend.pipeline.values import Candidates, Shortlist


def shortlist_by_reachability(config: Reachability, candidates: Candidates, context: RankContext) -> Shortlist:
    """Score by the arm's own signed distance, in metres, of pregrasp or grasp, whichever is less.

    What is not reachable is out, with its distance including the hand's height as score; the grasp the arm is moving
    to comes first while it is reachable.
    """
    field = context.reachability
    assert field is not None, "the cycle loads the field for methods that rank with it"
    n = len(candidates.quality)
    parts = field.parts(np.concatenate([candidates.Ts_world_pregrasp, candidates.Ts_world_grasp]))
    distance = parts.min(axis=1)
    worse = np.minimum(distance[:n], distance[n:])
    score = np.where(worse > 0.0, np.minimum(parts[:n, 0], parts[n:, 0]), worse)
    rejected = {int(i): _why(distance[i], distance[n + i]) for i in np.flatnonzero(worse <= 0.0)}
    rejected.update(dict.fromkeys(context.put_off, PUT_OFF))
    ranked = sorted(set(range(n)) - set(rejected), key=lambda i: (i != context.held, -score[i], i))
    rejected.update({i: "reachable, but others lie further inside" for i in ranked[config.keep :]})
    return Shortlist(candidates, tuple(ranked[: config.keep]), score, rejected, reachability_m=score)


def _why(pregrasp_m: float, grasp_m: float) -> str:
    which, beyond_m = ("pregrasp", -pregrasp_m) if pregrasp_m <= grasp_m else ("grasp", -grasp_m)
    return f"{which} out of reach by about {100.0 * beyond_m:.1f} cm"
