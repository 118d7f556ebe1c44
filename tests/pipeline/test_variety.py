"""Of grasps much alike only the best is kept: against a second way to measure turns, and by brute force."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from backend.knowledge.grasps import load_grasps
from backend.pipeline.filter.variety import APART_M, APART_RAD, alike, varied


@pytest.mark.parametrize("pair", [("ur5_robotiq", "power_drill"), ("mico", "sugar_box")])
def test_alike_is_what_quaternions_say(pair: tuple[str, str]):
    Ts = load_grasps(*pair).Ts_object_grasp
    turns = Rotation.from_matrix(Ts[:, :3, :3])
    found = alike(Ts)
    assert found.diagonal().all() and (found == found.T).all()
    assert 0.0 < found.mean() < 1.0
    for i in range(len(Ts)):
        turned = (turns[i].inv() * turns).magnitude()
        shifted = np.linalg.norm(Ts[:, :3, 3] - Ts[i, :3, 3], axis=1)
        apart = np.sqrt((turned / APART_RAD) ** 2 + (shifted / APART_M) ** 2)
        clear = np.abs(apart - 1.0) > 1e-9
        np.testing.assert_array_equal(found[i, clear], (apart < 1.0)[clear])


@given(st.data())
def test_the_kept_are_the_best_that_differ_and_then_the_best(data: st.DataObject):
    n = data.draw(st.integers(1, 12))
    near = np.array(data.draw(st.lists(st.lists(st.booleans(), min_size=n, max_size=n), min_size=n, max_size=n)))
    near = near | near.T | np.eye(n, dtype=bool)
    ranked = data.draw(st.permutations(range(n)))
    keep = data.draw(st.integers(1, n))
    kept, passed = varied(ranked, keep, near)
    assert len(kept) == keep == len(set(kept))
    assert kept == sorted(kept, key=ranked.index) and kept[0] == ranked[0]
    assert not passed & set(kept)
    for i in passed:
        assert any(near[i, k] for k in kept if ranked.index(k) < ranked.index(i))
    different = list[int]()
    for i in ranked:
        if not near[i, different].any():
            different.append(i)
    others = [i for i in ranked if i not in different]
    assert set(kept) == set(different[:keep]) | set(others[: max(keep - len(different), 0)])


def test_without_likeness_the_first_are_kept():
    assert varied([3, 1, 2], 2, None) == ([3, 1], frozenset())
