"""Trajectory: its largest speeds and accelerations against a fine sampling."""

import itertools

import numpy as np
import pytest

from backend.trajectory import Trajectory


def test_peaks_are_those_of_the_sampled_motion():
    rng = np.random.default_rng(1)
    t_s = np.cumsum(rng.uniform(0.05, 0.2, 12))
    trajectory = Trajectory(t_s, rng.normal(size=(12, 3)), rng.normal(size=(12, 3)))
    until_s = float(t_s[-1]) - 1e-6
    times = np.concatenate([np.linspace(a + 1e-9, b - 1e-9, 2001) for a, b in itertools.pairwise(t_s)])
    qd = np.array([trajectory.sample(float(t))[1] for t in times])
    velocity, acceleration = trajectory.peaks(until_s=until_s)
    assert np.allclose(velocity, np.abs(qd).max(axis=0), rtol=1e-4)
    rates = np.concatenate(
        [np.diff(part, axis=0) / (dt / 2000) for part, dt in zip(np.split(qd, len(t_s) - 1), np.diff(t_s), strict=True)]
    )
    assert np.allclose(acceleration, np.abs(rates).max(axis=0), rtol=5e-3)


def test_peaks_of_a_span_are_those_of_the_pieces_that_begin_in_it():
    q = np.array([[0.0], [1.0], [3.0], [3.5]])
    trajectory = Trajectory(np.array([4.0, 5.0, 6.0, 7.0]), q, np.array([[1.0], [1.0], [2.0], [0.5]]))
    assert trajectory.peaks(until_s=5.0)[0] == pytest.approx(1.0)
    assert trajectory.peaks(from_s=6.0)[0] == pytest.approx(2.0)
    assert trajectory.peaks(until_s=5.0)[1] == pytest.approx(0.0)
    assert not trajectory.peaks(from_s=7.0)[0].any()


def test_positions_are_those_of_single_samples_bit_for_bit():
    rng = np.random.default_rng(2)
    grid = np.cumsum(rng.uniform(0.01, 0.3, 9))
    trajectory = Trajectory(grid, rng.normal(size=(9, 6)), rng.normal(size=(9, 6)))
    times = np.concatenate([rng.uniform(grid[0] - 1.0, grid[-1] + 1.0, 500), grid, grid - 1e-12])
    one_by_one = np.array([trajectory.sample(float(t_s))[0] for t_s in times])
    assert (trajectory.positions(times) == one_by_one).all()
