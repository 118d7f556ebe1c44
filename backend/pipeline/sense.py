"""sense: World -> Observation, at a rate, with noise, latency and dropout."""

from collections import deque

import numpy as np

from backend.pipeline.values import Observation
from backend.pose import Pose
from backend.scenario import SensingConfig
from backend.sim.bullet import STEP_S
from backend.sim.world import World


class Sensor:
    """Looks at the world at a fixed rate and hands each look over after its latency."""

    def __init__(self, config: SensingConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._rng = rng
        self._every = max(1, round(1.0 / (config.rate_hz * STEP_S)))
        self._under_way: deque[Observation] = deque()

    def look(self, world: World) -> None:
        """Take an observation if one is due at this physics step."""
        if world.steps % self._every == 0:
            pose = self._detect(world.object_pose())
            self._under_way.append(Observation(world.t_s, world.q(), world.qd(), pose))

    def delivered(self, t_s: float) -> list[Observation]:
        """The observations that the robot learns of up to ``t_s`` and has not been given yet, oldest first."""
        out: list[Observation] = []
        while self._under_way and self._under_way[0].t_s + self._config.latency_s <= t_s + 1e-9:
            out.append(self._under_way.popleft())
        return out

    def _detect(self, T_world_object: Pose) -> Pose | None:
        """The pose as detected. Draws the same numbers whatever the settings, so that trials stay paired."""
        config = self._config
        lost = self._rng.random() < config.dropout
        noise = self._rng.standard_normal(4)
        if lost:
            return None
        if config.position_noise_std_m == 0.0 and config.yaw_noise_std_rad == 0.0:
            return T_world_object
        shift = Pose.of(noise[:3] * config.position_noise_std_m + T_world_object.xyz_m)
        turn = Pose.from_xyz_yaw((0.0, 0.0, 0.0), float(noise[3]) * config.yaw_noise_std_rad)
        return shift @ turn @ Pose.of(wxyz=T_world_object.wxyz)
