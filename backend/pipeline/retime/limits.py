"""JointLimits: what retiming obeys."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.pose import Array

VELOCITY_SHARE = 0.996
ACCELERATION_SHARE = 0.97
"""Shares of the limits that are used; the rest is for the curve between grid points."""


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Largest joint speeds and accelerations, the same in both directions."""

    velocity_rps: Array
    """(dof,) rad/s."""
    acceleration_rps2: Array
    """(dof,) rad/s^2."""

    @property
    def usable(self) -> bool:
        """Whether every limit is positive and finite."""
        both = np.concatenate([self.velocity_rps, self.acceleration_rps2])
        return bool(np.isfinite(both).all() and (both > 0.0).all())

    def used(self, qd_start: Array) -> JointLimits:
        """What a motion that begins at ``qd_start`` (dof,) rad/s may use of them."""
        velocity_rps = np.maximum(self.velocity_rps * VELOCITY_SHARE, np.abs(qd_start))
        return JointLimits(velocity_rps, self.acceleration_rps2 * ACCELERATION_SHARE)
