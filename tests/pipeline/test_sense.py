"""The senses: at their rate, late by their latency, as noisy and as blind as they are told to be."""

import numpy as np
import pytest

from backend.pipeline.sense import Sensor
from backend.pipeline.values import Observation
from backend.scenario import SensingConfig
from tests.sim.worlds import standing, world_of


def observations(config: SensingConfig, seconds: float = 1.0) -> list[tuple[float, Observation]]:
    """(time of delivery, observation) over a while of a belt in motion."""
    out: list[tuple[float, Observation]] = []
    with world_of("ur5_linear", "cube") as world:
        sensor = Sensor(config, np.random.default_rng(0))
        for _ in range(round(seconds * 240)):
            sensor.look(world)
            out += [(world.t_s, observation) for observation in sensor.delivered(world.t_s)]
            world.step(*standing(world))
    return out


@pytest.mark.parametrize("rate_hz", [5.0, 20.0, 60.0])
def test_observations_come_at_their_rate(rate_hz: float):
    times = np.array([observation.t_s for _, observation in observations(SensingConfig(rate_hz=rate_hz))])
    np.testing.assert_allclose(np.diff(times), 1.0 / rate_hz, atol=1e-9)


def test_latency_delays_the_news_and_not_the_view():
    for delivered_s, observation in observations(SensingConfig(latency_s=0.1)):
        assert 0.1 - 1e-9 <= delivered_s - observation.t_s < 0.1 + 1.01 / 240


def test_without_noise_the_truth_is_seen():
    seen = [o for _, o in observations(SensingConfig())]
    assert all(o.T_world_object is not None for o in seen)
    first, last = seen[0].T_world_object, seen[-1].T_world_object
    assert first is not None and last is not None
    speed_mps = np.linalg.norm(last.xyz_m - first.xyz_m) / (seen[-1].t_s - seen[0].t_s)
    assert speed_mps == pytest.approx(0.05, rel=1e-3)


def test_noise_has_the_size_it_is_said_to_have():
    exact = observations(SensingConfig(rate_hz=240.0), 3.0)
    noisy = observations(SensingConfig(rate_hz=240.0, position_noise_std_m=0.005, yaw_noise_std_rad=0.05), 3.0)
    shifts, turns = [], []
    for (_, a), (_, b) in zip(exact, noisy, strict=True):
        assert a.T_world_object is not None and b.T_world_object is not None
        shifts.append(b.T_world_object.xyz_m - a.T_world_object.xyz_m)
        turns.append((a.T_world_object.inverse() @ b.T_world_object).yaw_rad)
    np.testing.assert_allclose(np.std(shifts, axis=0), 0.005, rtol=0.15)
    assert np.std(turns) == pytest.approx(0.05, rel=0.15)


def test_dropouts_hide_their_share():
    seen = observations(SensingConfig(rate_hz=240.0, dropout=0.3), 3.0)
    assert np.mean([o.T_world_object is None for _, o in seen]) == pytest.approx(0.3, abs=0.06)
