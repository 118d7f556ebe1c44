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
