"""Shortcuts: a found path made shorter by straight edges that touch nothing (Geraerts and Overmars 2007)."""

import numpy as np

from backend.pipeline.plan.seed_path import CheckCount
from backend.pose import Array

ATTEMPTS = 40
LEAST_GAIN_RAD = 1e-3


def shorten(waypoints: Array, count: CheckCount, rng: np.random.Generator) -> Array:
    """(m, dof) a path with the same ends: waypoints dropped where possible, then corners cut at random."""
    path = _skip_waypoints(waypoints, count)
    for _ in range(ATTEMPTS):
        if len(path) == 2:
            break
        path = _cut(path, np.sort(rng.random(2)), count)
    return path


def _skip_waypoints(waypoints: Array, count: CheckCount) -> Array:
    """From each waypoint straight to the farthest one that can be reached."""
    keep = [0]
    while keep[-1] < len(waypoints) - 1:
        here = keep[-1]
        ahead = range(len(waypoints) - 1, here, -1)
        keep.append(next(j for j in ahead if j == here + 1 or count.edge_free(waypoints[here], waypoints[j])))
    return waypoints[keep]


def _cut(path: Array, at: Array, count: CheckCount) -> Array:
    """The path with the part between two fractions of its length replaced by an edge, when that is free."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    marks = np.concatenate([[0.0], np.cumsum(lengths)])
    (i, a), (j, b) = (_point(path, marks, fraction * marks[-1]) for fraction in at)
    gain = (marks[-1] * (at[1] - at[0])) - np.linalg.norm(b - a)
    if i == j or gain < LEAST_GAIN_RAD or not count.is_free(a):
        return path
    if not count.edge_free(a, b):
        return path
    return np.vstack([path[: i + 1], a, b, path[j + 1 :]])


def _point(path: Array, marks: Array, at: float) -> tuple[int, Array]:
    i = min(int(np.searchsorted(marks, at, side="right")) - 1, len(path) - 2)
    share = (at - marks[i]) / (marks[i + 1] - marks[i])
    return i, path[i] + share * (path[i + 1] - path[i])
