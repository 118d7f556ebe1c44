"""Random sequences of a moving object's poses, from which motion is learned: linear, circular and sinusoidal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.pipeline.predict.window import HORIZONS_S, WINDOW_S, Bools
from backend.pose import Array

LOOKS = 100
FULL_TURN_RAD = 2.0 * np.pi


@dataclass(frozen=True)
class SequenceSettings:
    """What is drawn; ranges are uniform, or log-uniform where said."""

    speed_mps: tuple[float, float] = (0.003, 0.1)
    """Log-uniform; of the progress along the axis for the sinusoid, whose upper end is halved."""
    radius_m: tuple[float, float] = (0.1, 1.0)
    """Of circles, log-uniform."""
    swing_slope: tuple[float, float] = (0.3, 3.0)
    """Of sinusoids where they cross their axis."""
    swing_period_m: tuple[float, float] = (0.15, 0.7)
    climb_rad: float = 0.4
    """Linear motion climbs or descends at up to this angle, in half of its sequences."""
    shares: tuple[float, float, float, float] = (0.4, 0.25, 0.3, 0.05)
    """Linear, circular, sinusoidal, still."""
    slow_change: float = 0.3
    """Share of sequences whose speed changes over 5 to 30 s, as it does on a belt of varying speed."""
    quick_change: float = 0.25
    """Share of sequences whose speed changes over 0.05 to 2 s."""
    reversal: float = 0.3
    """Share of the quick changes that end in the opposite direction."""
    noise_m: float = 0.006
    """Largest standard deviation of the position's noise, in each axis."""
    yaw_noise_rad: float = 0.1
    clean: float = 0.25
    """Share of sequences without noise."""
    interval_s: tuple[float, float] = (0.04, 0.2)
    """Between looks; half of the sequences have exactly 0.05 s."""
    dropout: float = 0.3
    """Largest share of looks that see nothing, in a third of the sequences."""


@dataclass(frozen=True, eq=False)
class Sequences:
    """b sequences of noisy looks and what comes after them; columns x, y, z, yaw."""

    age_s: Array
    """(b, LOOKS) before the newest look."""
    states: Array
    """(b, LOOKS, 4) as seen."""
    seen: Bools
    """(b, LOOKS)."""
    future: Array
    """(b, horizons, 4) as it really will be, ``HORIZONS_S`` after the newest look."""


def draw_sequences(n: int, rng: np.random.Generator, settings: SequenceSettings | None = None) -> Sequences:
    """``n`` sequences; the same generator state gives the same ones."""
    settings = settings or SequenceSettings()
    age_s = np.arange(LOOKS) * _intervals(n, rng, settings)
    t_s = np.concatenate([-age_s, np.broadcast_to(HORIZONS_S, (n, len(HORIZONS_S)))], axis=1)
    true = _placed(_paths(t_s, rng, settings), rng)
    noise = np.where(rng.random((n, 1)) < settings.clean, 0.0, rng.random((n, 2)))
    noise *= (settings.noise_m, settings.yaw_noise_rad)
    noise[:, 1] *= rng.random(n) < 0.5
    shaken = true[:, :LOOKS] + rng.standard_normal((n, LOOKS, 4)) * noise[:, None, [0, 0, 0, 1]]
    return Sequences(age_s, shaken, _seen(age_s, rng, settings), true[:, LOOKS:])


def _intervals(n: int, rng: np.random.Generator, settings: SequenceSettings) -> Array:
    drawn = rng.uniform(*settings.interval_s, (n, 1))
    return np.where(rng.random((n, 1)) < 0.5, 0.05, drawn)


def _seen(age_s: Array, rng: np.random.Generator, settings: SequenceSettings) -> Bools:
    """Everything since the object appeared, which may have been a moment ago, but for dropouts."""
    n = len(age_s)
    known_s = np.select(
        [(kind := rng.random((n, 1))) < 0.25, kind < 0.55],
        [rng.uniform(0.2, 1.5, (n, 1)), rng.uniform(1.0, WINDOW_S, (n, 1))],
        WINDOW_S,
    )
    lost = rng.random(age_s.shape) < settings.dropout * rng.random((n, 1)) * (rng.random((n, 1)) < 1 / 3)
    return (age_s <= known_s) & (~lost | (age_s == 0.0))


def _paths(t_s: Array, rng: np.random.Generator, settings: SequenceSettings) -> Array:
    """(b, n, 5) x, y, z, yaw of the object and heading of its motion, starting along x from the origin."""
    n = len(t_s)
    kind = rng.choice(4, size=(n, 1), p=settings.shares)
    low, high = np.log(settings.speed_mps)
    speed = np.exp(rng.uniform(low, high - np.log(2.0) * (kind == 2), (n, 1)))
    s = np.where(kind == 3, 0.0, _progress(t_s, speed, rng, settings))
    climb = rng.uniform(-settings.climb_rad, settings.climb_rad, (n, 1)) * (rng.random((n, 1)) < 0.5)
    tightest, widest = np.log(settings.radius_m)
    curvature = np.exp(-rng.uniform(tightest, widest, (n, 1))) * rng.choice([-1.0, 1.0], (n, 1))
    wave = FULL_TURN_RAD / rng.uniform(*settings.swing_period_m, (n, 1))
    slope, phase = rng.uniform(*settings.swing_slope, (n, 1)), rng.uniform(0.0, FULL_TURN_RAD, (n, 1))
    zero = np.zeros_like(s)
    line = np.stack([s * np.cos(climb), zero, s * np.sin(climb), zero], axis=2)
    angle = s * curvature
    circle = np.stack([np.sin(angle) / curvature, (1.0 - np.cos(angle)) / curvature, zero, angle], axis=2)
    swing = slope / wave * (np.sin(wave * s + phase) - np.sin(phase))
    sinusoid = np.stack([s, swing, zero, np.arctan(slope * np.cos(wave * s + phase))], axis=2)
    way = np.select([(kind == k)[..., None] for k in (0, 1, 2)], [line, circle, sinusoid], line)
    return np.concatenate([way[..., :3], _yaw(t_s, way[..., 3], rng)[..., None]], axis=2)


def _progress(t_s: Array, speed: Array, rng: np.random.Generator, settings: SequenceSettings) -> Array:
    """(b, n) metres since time 0 at an even speed, or one that goes over into another."""
    n = len(t_s)
    kind = rng.random((n, 1))
    quick = kind < settings.quick_change
    changes = kind < settings.quick_change + settings.slow_change
    over_s = np.where(quick, np.exp(rng.uniform(np.log(0.05), np.log(2.0), (n, 1))), rng.uniform(5.0, 30.0, (n, 1)))
    begin_s = rng.uniform(-WINDOW_S - over_s, HORIZONS_S[-1])
    factor = np.where(changes, np.exp(rng.uniform(-1.0, 1.0, (n, 1)) * np.where(quick, 3.0, 1.2)), 1.0)
    factor = np.clip(speed * factor, *settings.speed_mps) / speed
    back = quick & (rng.random((n, 1)) < settings.reversal)
    factor = np.where(back, -np.minimum(factor, 2.0), factor)
    u, u0 = (t_s - begin_s) / over_s, -begin_s / over_s
    return speed * (t_s + (factor - 1.0) * over_s * (_ramped(u) - _ramped(u0)))


def _ramped(u: Array) -> Array:
    """Integral of a ramp that rises from 0 to 1 while ``u`` does."""
    inside = np.clip(u, 0.0, 1.0)
    return 0.5 * inside**2 + np.maximum(u - 1.0, 0.0)


def _yaw(t_s: Array, heading: Array, rng: np.random.Generator) -> Array:
    """(b, n) the object's yaw: mostly kept, as on the belt's tray, or turning with the motion or by itself."""
    n = len(t_s)
    kind = rng.random((n, 1))
    spin = rng.uniform(-0.5, 0.5, (n, 1)) * t_s
    return np.select([kind < 0.7, kind < 0.85], [np.zeros_like(t_s), heading], spin)


def _placed(path: Array, rng: np.random.Generator) -> Array:
    """The same paths anywhere in the world, in any direction."""
    n = len(path)
    angle = rng.uniform(0.0, FULL_TURN_RAD, (n, 1))
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = path[..., 0], path[..., 1]
    offset = rng.uniform(-1.0, 1.0, (n, 1, 4))
    return np.stack([cos * x - sin * y, sin * x + cos * y, path[..., 2], path[..., 3]], axis=2) + offset
