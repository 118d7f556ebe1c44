"""How far ahead the object is predicted."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.methods.method import Intercept, StepHorizon
from backend.pipeline.horizon import Underway, horizon_s


@pytest.mark.parametrize(("gap_m", "ahead_s"), [(0.31, 2.0), (0.29, 1.0), (0.11, 1.0), (0.09, 0.0)])
def test_the_papers_steps(gap_m: float, ahead_s: float):
    assert horizon_s(StepHorizon(), Underway(gap_m, left_s=5.0)) == ahead_s
    assert horizon_s(StepHorizon(), None) == 2.0


@given(st.floats(-1.0, 20.0), st.floats(0.0, 2.0))
def test_an_intercept_is_what_is_left_of_the_motion(left_s: float, gap_m: float):
    config = Intercept(longest_s=6.0)
    ahead_s = horizon_s(config, Underway(gap_m, left_s))
    assert 0.0 <= ahead_s <= 6.0
    if 0.0 <= left_s <= 6.0:
        assert ahead_s == left_s


def test_an_intercept_begins_with_a_guess():
    assert horizon_s(Intercept(first_s=1.5), None) == 1.5
