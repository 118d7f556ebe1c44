"""Evenly spread directions."""

import numpy as np

from backend.pose import Array


def fibonacci_sphere(count: int) -> Array:
    """(count, 3) evenly spread unit vectors."""
    i = np.arange(count) + 0.5
    z = 1.0 - 2.0 * i / count
    angle = i * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
