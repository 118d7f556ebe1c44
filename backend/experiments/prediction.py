"""How far off predictions are, on the motions of the tasks and on motions that no predictor was made for."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from backend.errors import lookup
from backend.methods.method import ConstantVelocity, Kalman, LastPose, Lstm, PredictorConfig
from backend.pipeline.predict import Predictor, make_predictor
from backend.pipeline.values import Observation
from backend.pose import Array, Pose
from backend.scenario import load_scenario
from backend.tasks.belt import DrawnBelt, between

PREDICTORS = ("lstm", "kalman", "kalman_told", "constant_velocity", "last_pose")
"""``kalman_told`` is the Kalman filter that is told the noise, which no other is."""
UNSURE = ("lstm", "kalman", "kalman_told")
"""Those that say how far off they may be."""
EXACT_M = 1e-6
"""Who is off by less is always within what was said."""
NOISES_M = (0.0, 0.002, 0.005)
"""Standard deviations of the position's noise, in each axis."""
AHEAD_S = (0.5, 1.0, 2.0, 4.0, 8.0)
LOOK_EVERY_S = 0.05
ASK_EVERY = 10
FIRST_LOOKS = 20
LONGEST_S = 40.0
ROBOTS = ("mico", "ur5")
SPEED_MPS = 0.03
"""Of the motions that are not of the tasks."""

Way = Callable[[Array], Array]
"""(n, 3) positions in metres at n times."""


@dataclass(frozen=True)
class Family:
    """A kind of motion."""

    name: str
    of_the_tasks: bool
    draw: Callable[[np.random.Generator], tuple[Way, float]]
    """One motion, and how many seconds of it are used."""


@dataclass(frozen=True, eq=False)
class Errors:
    """How far off one predictor was on one family under one noise."""

    family: str
    of_the_tasks: bool
    noise_m: float
    predictor: str
    off_m: Array
    """(n, 5) distances from the truth, ``AHEAD_S`` ahead."""
    two_sigma_m: Array
    """(n, 5) twice the standard deviation that was claimed."""
    median_predict_s: float
    """Wall time of one prediction."""

    def as_dict(self) -> dict[str, object]:
        """Millimetres, and shares within two standard deviations, as lists over ``AHEAD_S``."""
        within = (self.off_m <= self.two_sigma_m + EXACT_M).mean(axis=0).round(4).tolist()
        return {
            "family": self.family,
            "of_the_tasks": self.of_the_tasks,
            "noise_mm": 1e3 * self.noise_m,
            "predictor": self.predictor,
            "predictions": len(self.off_m),
            "mean_mm": (1e3 * self.off_m.mean(axis=0)).round(3).tolist(),
            "p95_mm": (1e3 * np.percentile(self.off_m, 95, axis=0)).round(3).tolist(),
            "within_two_sigma": within if self.predictor in UNSURE else None,
            "median_predict_ms": round(1e3 * self.median_predict_s, 4),
        }


def families() -> list[Family]:
    """Linear (which is also the motion with obstacles and under the slab) and the other tasks, then the unseen."""
    kinds = ("linear", "linear_z", "linear_varying", "circular", "sinusoidal")
    of_tasks = [Family(f"{robot}_{kind}", True, _of_scenario(f"{robot}_{kind}")) for kind in kinds for robot in ROBOTS]
    return [
        *of_tasks,
        Family("figure_eight", False, _figure_eight),
        Family("stop_and_go", False, _stop_and_go),
        Family("sharp_turn", False, _sharp_turn),
    ]


def measure(motions: int, seed: int, only: Sequence[str] | None = None) -> Iterator[Errors]:
    """The errors of every predictor on ``motions`` motions of every family (or of ``only`` some) under every noise.

    All predictors see the same noise. They are asked every 0.5 s, from the first second on until 2 s before the
    motion's end, at most 40 s of it. Raises ``NotFoundError`` for a family that is not there.
    """
    table = {family.name: (index, family) for index, family in enumerate(families())}
    chosen = list(table.values()) if only is None else [lookup("family of motion", name, table) for name in only]
    for (index, family), (level, noise_m) in product(chosen, enumerate(NOISES_M)):
        drawn = [_drawn(family, noise_m, [seed, index, k, level]) for k in range(motions)]
        for name in PREDICTORS:
            runs = [_run(make_predictor(_config(name, noise_m), _forbidden), *trial) for trial in drawn]
            off_m, two_sigma_m, took_s = (np.concatenate(parts) for parts in zip(*runs, strict=True))
            median_s = float(np.median(took_s))
            yield Errors(family.name, family.of_the_tasks, noise_m, name, off_m, two_sigma_m, median_s)


def _config(name: str, noise_m: float) -> PredictorConfig:
    configs: dict[str, PredictorConfig] = {
        "lstm": Lstm(),
        "kalman": Kalman(),
        "kalman_told": Kalman(acceleration_std_mps2=0.002, measurement_std_m=max(noise_m, 1e-4)),
        "constant_velocity": ConstantVelocity(),
        "last_pose": LastPose(),
    }
    return configs[name]


def _drawn(family: Family, noise_m: float, seed: list[int]) -> tuple[Way, Array, Array]:
    """A motion, the times it is looked at, and what is seen there (n, 3)."""
    way, duration_s = family.draw(np.random.default_rng(seed[:3]))
    t_s = np.arange(0.0, min(duration_s, LONGEST_S) - AHEAD_S[-1], LOOK_EVERY_S)
    noise = np.random.default_rng(seed).standard_normal((len(t_s), 3))
    return way, t_s, way(t_s) + noise_m * noise


def _run(predictor: Predictor, way: Way, t_s: Array, seen_m: Array) -> tuple[Array, Array, Array]:
    """(n, 5) errors and twice the claimed standard deviations, in metres, and (n,) wall times of the predictions."""
    ahead = np.array(AHEAD_S)
    off: list[Array] = []
    claimed: list[Array] = []
    took: list[float] = []
    for k, (now, xyz) in enumerate(zip(t_s.tolist(), seen_m, strict=True)):
        predictor.observe(Observation(now, np.zeros(6), np.zeros(6), Pose.from_xyz_yaw(xyz, 0.3)))
        if k >= FIRST_LOOKS and k % ASK_EVERY == 0:
            begun_s = time.perf_counter()
            prediction = predictor.predict(now + ahead)
            took.append(time.perf_counter() - begun_s)
            assert prediction is not None
            off.append(np.linalg.norm(prediction.Ts_world_object[:, :3, 3] - way(now + ahead), axis=1))
            claimed.append(2.0 * prediction.position_std_m)
    return np.array(off), np.array(claimed), np.array(took)


def _of_scenario(name: str) -> Callable[[np.random.Generator], tuple[Way, float]]:
    """Motions as the task of a scenario file draws them."""
    task = load_scenario(name).task

    def draw(rng: np.random.Generator) -> tuple[Way, float]:
        shares = rng.random(4)
        direction: Literal[1, -1] = 1 if rng.random() < 0.5 else -1
        motion = task.motion(
            DrawnBelt(
                theta_rad=between(task.theta_min_rad, task.theta_max_rad, shares[0]),
                distance_m=between(task.distance_min_m, task.distance_max_m, shares[1]),
                direction=direction,
                length_m=task.length_m,
                start_height_share=shares[2],
                end_height_share=shares[3],
                object_yaw_rad=0.0,
            )
        )
        return lambda t_s: np.array([motion.pose_at(t).xyz_m for t in t_s.tolist()]), motion.duration_s

    return draw


def _figure_eight(rng: np.random.Generator) -> tuple[Way, float]:
    """A Lissajous figure 0.3 to 0.6 m long; the mean speed is about 3 cm/s."""
    half_m, phase = rng.uniform(0.15, 0.3), rng.uniform(0.0, 2.0 * np.pi)
    rate = SPEED_MPS / half_m

    def way(t_s: Array) -> Array:
        angle = rate * t_s + phase
        return half_m * np.stack([np.sin(angle), 0.5 * np.sin(2.0 * angle), np.zeros_like(t_s)], axis=-1)

    return way, LONGEST_S


def _stop_and_go(rng: np.random.Generator) -> tuple[Way, float]:
    """Straight on for 2 to 6 s, then still for 1 to 4 s, and so on, without ramps."""
    spans = rng.uniform([2.0, 1.0], [6.0, 4.0], (20, 2)).ravel()
    times = np.concatenate([[0.0], np.cumsum(spans)])
    progress = np.concatenate([[0.0], np.cumsum(spans * np.tile([SPEED_MPS, 0.0], 20))])
    ahead = _direction(rng)
    return lambda t_s: np.interp(t_s, times, progress)[..., None] * ahead, LONGEST_S


def _sharp_turn(rng: np.random.Generator) -> tuple[Way, float]:
    """Straight on, and around a corner of 45 to 135 degrees every 4 to 8 s."""
    spans = rng.uniform(4.0, 8.0, 10)
    turns = rng.uniform(np.pi / 4, 3 * np.pi / 4, 10) * rng.choice([-1.0, 1.0], 10)
    heading = rng.uniform(0.0, 2.0 * np.pi) + np.cumsum(turns)
    legs = SPEED_MPS * spans[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    times = np.concatenate([[0.0], np.cumsum(spans)])
    corners = np.concatenate([np.zeros((1, 2)), np.cumsum(legs, axis=0)])

    def way(t_s: Array) -> Array:
        x, y = (np.interp(t_s, times, corners[:, axis]) for axis in (0, 1))
        return np.stack([x, y, np.zeros_like(t_s)], axis=-1)

    return way, LONGEST_S


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _forbidden(t_s: float) -> Pose:
    raise AssertionError("a causal predictor asked for the truth")
