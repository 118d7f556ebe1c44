"""Laws of how far one way leads from another."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from backend.deviation import deviation, length

WAYS = arrays(np.float64, st.tuples(st.integers(1, 6), st.just(3)), elements=st.floats(-3.0, 3.0))


def test_deviation_is_the_farthest_point_of_the_path():
    reference = np.array([[0.0, 0.0], [1.0, 0.0]])
    assert deviation(reference, reference, 0.02) == 0.0
    assert deviation(np.array([[0.0, 0.0], [0.5, 0.3], [1.0, 0.0]]), reference, 0.02) == pytest.approx(0.3)
    assert deviation(np.array([[0.0, 0.0], [2.0, 0.0]]), reference, 0.02) == pytest.approx(1.0)


@given(WAYS)
def test_no_way_deviates_from_itself(points: np.ndarray) -> None:
    assert deviation(points, points, 0.1) == pytest.approx(0.0, abs=1e-6)


@given(WAYS, WAYS)
def test_a_deviation_is_what_sampling_both_finely_comes_to(points: np.ndarray, reference: np.ndarray) -> None:
    def fine(way: np.ndarray) -> np.ndarray:
        edges = [np.linspace(a, b, 200) for a, b in itertools.pairwise(way)]
        return np.concatenate([way[:1], *edges])

    gaps = np.linalg.norm(fine(points)[:, None] - fine(reference)[None], axis=2).min(axis=1)
    assert deviation(points, reference, 0.01) == pytest.approx(gaps.max(), abs=0.04)


def test_length_is_the_sum_of_the_edges() -> None:
    assert length(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]])) == 6.0 and length(np.zeros((1, 2))) == 0.0
