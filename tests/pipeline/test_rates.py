"""Compiled rates against numpy's gradient and against the trajectory's own exact peaks."""

import numpy as np
import pytest

from backend.pipeline.retime.rates import speeds, times_too_fast
from backend.trajectory import Trajectory


def test_speeds_are_numpys_gradient_from_the_start_on():
    rng = np.random.default_rng(0)
    qs, start = rng.normal(size=(40, 6)), rng.normal(size=6)
    t_s = np.linspace(2.0, 2.9, 40)
    found = speeds(qs, t_s, start)
    np.testing.assert_array_equal(found[0], start)
    np.testing.assert_allclose(found[1:], np.gradient(qs, t_s, axis=0)[1:], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("span", [(-np.inf, np.inf), (1.0, 2.0), (1.5, np.inf), (9.0, np.inf)])
def test_how_much_too_fast_is_what_the_peaks_say(span: tuple[float, float]):
    rng = np.random.default_rng(1)
    t_s = np.cumsum(rng.uniform(0.05, 0.3, 20))
    trajectory = Trajectory(t_s, rng.normal(size=(20, 6)), rng.normal(size=(20, 6)))
    velocity_rps, acceleration_rps2 = rng.uniform(0.5, 2.0, 6), rng.uniform(0.5, 2.0, 6)
    velocity, acceleration = trajectory.peaks(*span)
    wanted = max((velocity / velocity_rps).max(), np.sqrt((acceleration / acceleration_rps2).max()))
    found = times_too_fast(t_s, trajectory.q, trajectory.qd, velocity_rps, acceleration_rps2, *span)
    assert found == pytest.approx(wanted, rel=1e-12)
