"""Success over speed and direction: what simulation did, and what the model said of the same attempts."""

from __future__ import annotations

from typing import Any

import numpy as np

from backend.build.attempts import Attempts
from backend.pose import Array

SPEED_BINS = 6
DIRECTION_BINS = 8
LEVEL_ENOUGH = 0.5
"""Approaches count as sideways when the horizontal part of their unit vector is longer."""

Curve = dict[str, Any]


def curves(attempts: Attempts, probability: Array, speeds_mps: tuple[float, float]) -> dict[str, Curve]:
    """Counts, successes and mean probabilities by speed (m/s), by direction in the object frame, and by the angle from
    the hand's approach to the motion, for hands that come from the side (rad): 0 is from behind, pi head-on."""
    turns = np.linspace(-np.pi, np.pi, DIRECTION_BINS + 1)
    approach = attempts.Ts_object_grasp[:, :2, 2]
    sideways = np.linalg.norm(approach, axis=1) > LEVEL_ENOUGH
    across = attempts.direction_rad - np.arctan2(approach[:, 1], approach[:, 0])
    from_behind = np.abs((across + np.pi) % (2.0 * np.pi) - np.pi)
    held = attempts.held.astype(np.float64)
    return {
        "speed_mps": _curve(attempts.speed_mps, np.linspace(*speeds_mps, SPEED_BINS + 1), held, probability),
        "direction_rad": _curve(attempts.direction_rad, turns, held, probability),
        "from_behind_rad": _curve(
            from_behind[sideways], np.linspace(0.0, np.pi, 7), held[sideways], probability[sideways]
        ),
    }


def _curve(values: Array, edges: Array, held: Array, probability: Array) -> Curve:
    bins = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(bins, minlength=len(edges) - 1)
    some = np.maximum(count, 1)
    return {
        "edges": edges.round(4).tolist(),
        "n": count.tolist(),
        "held": np.bincount(bins, weights=held, minlength=len(count)).astype(int).tolist(),
        "model": (np.bincount(bins, weights=probability, minlength=len(count)) / some).round(4).tolist(),
    }
