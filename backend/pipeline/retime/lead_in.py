"""Lead-ins: ways from the arm's current velocity onto a path, the most direct first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from backend.pipeline.retime.curve import Curve, hermite, rounded
from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array

STILL_RPS = 1e-6
"""Slower than this is standing."""
ALONG = 1.0 - 1e-6
"""Cosine between velocity and path beyond which no lead-in is needed."""
STRETCH = (1.3, 1.8, 2.5, 4.0)
"""Duration of the lead-in over the least time that the change of velocity takes."""
SPEED_SHARES = (0.9, 0.5, 0.2)
"""Speed at which the lead-in joins the path, over the fastest there."""
CORNER_RAD = 0.03
"""How far the curve may cut a corner of the path."""
TIGHT_CORNER_RAD = 0.003


@dataclass(frozen=True, eq=False)
class Approach:
    """A curve from where the arm is, and the speed along its parameter at the start."""

    curve: Curve
    start_speed: float


def approaches(waypoints: Array, qd_start: Array, limits: JointLimits) -> Iterator[Approach]:
    """Curves from ``qd_start`` along the path (n, dof), best first; the last can always be timed."""
    speed = float(np.linalg.norm(qd_start))
    if speed < STILL_RPS:
        yield Approach(rounded(waypoints, CORNER_RAD), 0.0)
        yield Approach(rounded(waypoints, TIGHT_CORNER_RAD), 0.0)
        return
    if len(waypoints) > 1:
        path = rounded(waypoints, CORNER_RAD)
        if qd_start @ path.coefficients[0, 1] > ALONG * speed:
            yield Approach(_aligned(path, qd_start / speed), speed)
        yield from _blends(path, qd_start, limits)
    for deviation_rad in (CORNER_RAD, TIGHT_CORNER_RAD):
        yield Approach(rounded(_brake_first(waypoints, qd_start, limits), deviation_rad), speed)


def _aligned(path: Curve, direction: Array) -> Curve:
    """The path with its first derivative turned exactly into ``direction``."""
    coefficients = path.coefficients.copy()
    c0, c1, c2, c3 = coefficients[0]
    length = path.lengths[0]
    end = c0 + length * (c1 + length * (c2 + length * c3))
    slope = c1 + length * (2.0 * c2 + 3.0 * length * c3)
    coefficients[0] = hermite(c0, direction, end, slope, float(length)).coefficients[0]
    return Curve(coefficients, path.lengths)


def _blends(path: Curve, qd: Array, limits: JointLimits) -> Iterator[Approach]:
    """Cubics that turn ``qd`` into the path's direction and join the path ahead."""
    direction = path.coefficients[0, 1]
    fastest = float((limits.velocity_rps / np.maximum(np.abs(direction), 1e-9)).min())
    for share in SPEED_SHARES:
        speed = max(share * fastest, 1e-3)
        least_s = float((np.abs(speed * direction - qd) / limits.acceleration_rps2).max())
        for stretch in STRETCH:
            duration_s = stretch * least_s
            way = max(0.5 * (float(qd @ direction) + speed), 0.25 * speed) * duration_s
            if way >= path.length:
                break
            rest = path.from_mark(way)
            q1, slope1 = rest.coefficients[0, 0], rest.coefficients[0, 1]
            start = hermite(path.coefficients[0, 0], qd / speed, q1, slope1, duration_s * speed)
            yield Approach(rest.after(start), speed)


def _brake_first(waypoints: Array, qd: Array, limits: JointLimits) -> Array:
    """(n + 1, dof) the path with a detour along ``qd`` on which the arm can come to rest."""
    stop_s = 1.05 * float((np.abs(qd) / limits.acceleration_rps2).max())
    way = qd * stop_s
    corner = waypoints[0] + way
    rest = waypoints[1:] if len(waypoints) > 1 else waypoints
    if np.linalg.norm(rest[0] - corner) < 1e-6:
        rest = rest[1:]
    return np.vstack([waypoints[0], corner, rest])
