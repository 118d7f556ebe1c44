"""The previous path, cut off where the arm is, tidied and bent to a new end: against slow and plain numpy."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.pipeline.plan.chomp_descent import line_along
from backend.pipeline.plan.ends import Ends
from backend.pipeline.plan.seed_path import ahead, without_repeats
from backend.pose import Array
from backend.trajectory import Path

SEEDS = st.integers(0, 10_000)


def drawn(seed: int, n: int) -> Array:
    return np.cumsum(np.random.default_rng(seed).normal(size=(n, 6)), axis=0)


def at(q: Array) -> Ends:
    return Ends(q[None], ((0, q),))


@given(SEEDS, st.integers(2, 9), st.floats(0.0, 1.0))
def test_what_is_ahead_begins_after_the_nearest_point(seed: int, n: int, share: float):
    path, rng = drawn(seed, n), np.random.default_rng(seed + 1)
    edge = int(rng.integers(n - 1))
    q = path[edge] + share * (path[edge + 1] - path[edge]) + rng.normal(scale=1e-3, size=6)
    fine = np.linspace(0.0, 1.0, 2001)[:, None]
    gaps = [np.linalg.norm(a + fine * (b - a) - q, axis=1).min() for a, b in pairwise(path)]
    rest = ahead(at(q), Path(path))
    if 0.01 < share < 0.99:
        np.testing.assert_array_equal(rest, path[int(np.argmin(gaps)) + 1 :])
    else:
        assert len(rest) in {n - 1 - edge, n - 2 - edge, n - edge}


def test_a_waypoint_that_the_arm_is_at_is_not_ahead():
    path = drawn(0, 5)
    np.testing.assert_array_equal(ahead(at(path[2]), Path(path)), path[3:])
    assert len(ahead(at(path[4]), Path(path))) == 0


@pytest.mark.parametrize("waypoints", [np.zeros((0, 6)), np.full((3, 6), np.nan), np.zeros((3, 5)), np.zeros(6)])
def test_nothing_is_ahead_on_a_path_that_is_none(waypoints: Array):
    assert ahead(at(np.zeros(6)), Path(waypoints)).shape == (0, 6)


@given(SEEDS, st.lists(st.integers(1, 3), min_size=1, max_size=8))
def test_repeats_go_and_the_ends_stay_exact(seed: int, times: list[int]):
    different = drawn(seed, len(times))
    path = np.repeat(different, times, axis=0)
    path[:-1] += np.random.default_rng(seed).uniform(-1e-8, 1e-8, size=path[:-1].shape)
    tidy = without_repeats(path)
    assert len(tidy) == len(times)
    np.testing.assert_allclose(tidy, different, atol=2e-8)
    np.testing.assert_array_equal(tidy[-1], path[-1])
    if len(times) > 1:
        np.testing.assert_array_equal(tidy[0], path[0])


@given(SEEDS, st.integers(2, 9), st.integers(1, 30))
def test_a_line_along_a_path_is_evenly_interpolated_and_moved_to_its_new_end(seed: int, n: int, count: int):
    chain = drawn(seed, n)
    goal = chain[-1] + np.random.default_rng(seed).normal(scale=0.1, size=6)
    marks = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(chain, axis=0), axis=1))])
    share = np.linspace(0.0, 1.0, count + 2)
    expected = np.stack([np.interp(share * marks[-1], marks, joint) for joint in chain.T], axis=1)
    expected += share[:, None] * (goal - chain[-1])
    line = line_along(chain, goal, count)
    np.testing.assert_allclose(line, expected, atol=1e-12)
    np.testing.assert_array_equal(line[[0, -1]], [chain[0], goal])


def test_a_line_along_a_path_of_no_length_stays():
    q = np.ones(6)
    np.testing.assert_array_equal(line_along(np.stack([q, q]), q, 4), np.tile(q, (6, 1)))
