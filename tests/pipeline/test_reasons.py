"""Reasons that are worded when read are the same reasons, here and in another process."""

import pickle

import pytest

from backend.pipeline.reasons import Reasons, with_others

FEW = Reasons([3, 1, 2], lambda index: f"grasp {index} is too far")


def test_nothing_is_worded_before_it_is_read():
    def never(index: int) -> str:
        raise AssertionError(index)

    reasons = Reasons([1, 2], never)
    assert list(reasons) == [1, 2] and 2 in reasons and 5 not in reasons
    assert set(with_others(reasons, {4: "no"})) == {1, 2, 4}


def test_what_is_not_there_has_no_reason():
    assert FEW.get(7) is None
    with pytest.raises(KeyError):
        FEW[7]


def test_the_others_have_the_last_word_and_come_after():
    both = with_others(FEW, {2: "touches the slab", 9: "blocked"})
    assert list(both) == [3, 1, 2, 9]
    assert both[2] == "touches the slab" and both[3] == "grasp 3 is too far"
    assert with_others(FEW, {}) is FEW


def test_another_process_gets_them_in_words():
    both = with_others(FEW, {2: "touches the slab"})
    assert pickle.loads(pickle.dumps(both)) == {3: FEW[3], 1: FEW[1], 2: "touches the slab"}
