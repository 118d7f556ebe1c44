"""The convex outline of points in a plane."""

import numpy as np

from backend.pose import Array


def convex_outline(points: Array) -> Array:
    """(k, 2) corners of the convex hull of points (n, 2), counter-clockwise from the leftmost.

    Andrew's monotone chain (1979). Points in line with their neighbours are no corners.
    """
    ordered = np.unique(points, axis=0).tolist()
    if len(ordered) < 3:
        return np.array(ordered)
    return np.array(_chain(ordered) + _chain(ordered[::-1]))


def _chain(ordered: list[list[float]]) -> list[list[float]]:
    """The hull from the first point to the one before the last, on the right-hand side of the way."""
    kept: list[list[float]] = []
    for x, y in ordered:
        while len(kept) > 1:
            (ax, ay), (bx, by) = kept[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            kept.pop()
        kept.append([x, y])
    return kept[:-1]
