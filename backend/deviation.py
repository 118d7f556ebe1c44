"""Deviation: how far one way leads from another."""

from __future__ import annotations

import itertools

import numpy as np

from backend.pose import Array


def deviation(points: Array, reference: Array, spacing: float) -> float:
    """Largest distance from one polyline (n, d) to another (m, d), in their unit.

    The first is looked at every ``spacing`` or closer; distances to the second are exact.
    """
    dense = _dense(points, spacing)
    if len(reference) == 1:
        return float(np.linalg.norm(dense - reference[0], axis=1).max())
    edges = np.diff(reference, axis=0)
    squares = np.maximum((edges**2).sum(axis=1), 1e-12)
    away = dense[:, None] - reference[:-1]
    along = np.clip((away * edges).sum(axis=2) / squares, 0.0, 1.0)
    return float(np.linalg.norm(away - along[..., None] * edges, axis=2).min(axis=1).max())


def length(points: Array) -> float:
    """Of a polyline (n, d), in its unit."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _dense(points: Array, spacing: float) -> Array:
    parts = [points[:1]]
    for a, b in itertools.pairwise(points):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / spacing)))
        parts.append(a + np.linspace(0.0, 1.0, count + 1)[1:, None] * (b - a))
    return np.concatenate(parts)
