"""JointLimits: what retiming obeys."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.pose import Array


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


def max_speed_ratio(t_s: Array, qs: Array, limits: JointLimits) -> float:
    """Largest joint speed over its limit when (n, dof) postures are passed at increasing times (n,)."""
    if len(qs) < 2:
        return 0.0
    speeds = np.abs(np.diff(qs, axis=0)) / np.diff(t_s)[:, None]
    return float((speeds / limits.velocity_rps).max())
