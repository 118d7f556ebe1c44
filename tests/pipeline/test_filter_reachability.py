"""The filter that ranks by reachability: what it keeps, what it says of the rest, and the grasp being moved to."""

import numpy as np
import pytest

from backend.knowledge.grasps import load_grasps
from backend.methods.method import Reachability
from backend.pipeline.convert import convert
from backend.pipeline.filter import shortlist
from backend.pipeline.filter.ranking import PUT_OFF
from backend.pipeline.filter.variety import alike
from backend.pipeline.values import Shortlist
from backend.pose import Pose
from tests.pipeline.contexts import OBJECT, context_of


def ranked(
    x_m: float, held: int | None = None, put_off: frozenset[int] = frozenset(), *, varied: bool = True
) -> Shortlist:
    context = context_of(held, put_off)
    grasps = load_grasps("ur5_robotiq", OBJECT)
    return shortlist(
        Reachability(varied=varied), convert(grasps, Pose.from_xyz_yaw((x_m, 0.1, 0.02), 0.4), 0.075), context
    )


@pytest.mark.parametrize("x_m", [0.5, 0.8, 1.1])
def test_every_grasp_is_kept_or_has_a_reason(x_m: float):
    short = ranked(x_m)
    assert len(short.kept) <= 10
    assert set(short.kept) | set(short.rejected) == set(range(len(short.score)))
    assert not set(short.kept) & set(short.rejected)
    assert all(short.rejected.values())


def test_the_best_come_first_and_are_better_than_the_rest():
    short = ranked(0.5, varied=False)
    kept = short.score[list(short.kept)]
    assert len(kept) == 10 and (np.diff(kept) <= 0.0).all()
    assert kept.min() > 0.0 and kept.min() >= short.score[list(short.rejected)].max()


def test_of_grasps_much_alike_the_best_is_kept_and_the_others_say_so():
    short, plain = ranked(0.5), ranked(0.5, varied=False)
    assert short.kept[0] == plain.kept[0] and len(short.kept) == 10
    near = alike(short.candidates.Ts_world_grasp)
    passed = [i for i, why in short.rejected.items() if why == "reachable, but much like one that is kept"]
    assert passed
    for i in passed:
        assert any(near[i, k] and short.score[k] >= short.score[i] for k in short.kept)
    better = {i for i in short.rejected if short.score[i] > short.score[list(short.kept)].min()}
    assert better <= set(passed)


def test_the_held_grasp_stays_while_it_is_reachable():
    free = ranked(0.8)
    worst = min((i for i in range(len(free.score)) if free.score[i] > 0.0), key=lambda i: free.score[i])
    out = int(np.argmin(free.score))
    assert free.score[out] <= 0.0
    assert ranked(0.8, held=worst).kept[0] == worst
    assert out not in ranked(0.8, held=out).kept


def test_a_refused_grasp_is_put_off():
    best = ranked(0.5).kept[0]
    again = ranked(0.5, put_off=frozenset({best}))
    assert best not in again.kept and again.rejected[best] == PUT_OFF


def test_out_of_reach_is_said_in_centimetres():
    short = ranked(1.6)
    assert short.kept == ()
    assert all("out of reach by about" in why and why.endswith("cm") for why in short.rejected.values())
