"""Time-optimal speed along a curve by the library toppra; the only file that imports it."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint
from toppra.interpolator import AbstractGeometricPath

from backend.pipeline.retime.curve import Curve
from backend.pipeline.retime.limits import JointLimits
from backend.pose import Array


class _Geometry(AbstractGeometricPath):  # pyright: ignore[reportUntypedBaseClass]
    """A ``Curve`` as toppra wants to see it."""

    def __init__(self, curve: Curve) -> None:
        self._curve = curve

    def __call__(self, path_positions: Any, order: int = 0) -> Array:
        s = np.atleast_1d(np.asarray(path_positions, dtype=np.float64))
        values = self._curve.at(s, order)
        return values if np.ndim(path_positions) else values[0]

    @property
    def dof(self) -> int:
        return self._curve.coefficients.shape[2]

    @property
    def path_interval(self) -> Array:
        return np.array([0.0, self._curve.length])


def toppra_speeds(curve: Curve, grid: Array, limits: JointLimits, start_speed: float) -> Array | None:
    """Speed (n,) along the curve's parameter at the grid (n,), ending at rest; None when there is none."""
    logging.getLogger("toppra").setLevel(logging.CRITICAL)
    velocity, acceleration = limits.velocity_rps, limits.acceleration_rps2
    constraints = [
        JointVelocityConstraint(np.column_stack([-velocity, velocity])),
        JointAccelerationConstraint(np.column_stack([-acceleration, acceleration])),
    ]
    solver = TOPPRA(constraints, _Geometry(curve), gridpoints=grid, solver_wrapper="seidel")
    speeds = solver.compute_parameterization(start_speed, 0.0)[1]
    if speeds is None or not np.isfinite(speeds).all():
        return None
    return np.asarray(speeds, dtype=np.float64)
