"""Relative way: where the hand is to be from the grasp it goes in to, in the frame of the moving object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.pipeline.execute.blend import rotations, rotvec, to_zero
from backend.pose import Array


@dataclass(frozen=True, eq=False)
class Offset:
    """One part of a way: a distance, a rotation vector or both at once, that goes to zero."""

    start: Array
    """(6,) position in m and rotation vector in rad of the tcp in the grasp's frame."""
    rate: Array
    """(6,) how fast it changes at first, per second."""
    begin_s: float
    end_s: float

    def at(self, t_s: Array) -> Array:
        """(n, 6) at simulated times (n,); before it begins, as fast as when it does."""
        since_s = t_s - self.begin_s
        before = np.minimum(since_s, 0.0)[:, None] * self.rate
        return before + to_zero(self.start, self.rate, self.end_s - self.begin_s, since_s)


@dataclass(frozen=True, eq=False)
class RelativeWay:
    """The sum of offsets, each of which goes to zero in its own time: at the last end the hand is at the grasp."""

    offsets: tuple[Offset, ...]

    def at(self, t_s: Array) -> Array:
        """(n, 6) position in m and rotation vector in rad of the tcp in the grasp's frame at simulated times (n,)."""
        return np.sum([offset.at(t_s) for offset in self.offsets], axis=0)

    def Ts_grasp_tcp(self, t_s: Array) -> Array:
        """(n, 4, 4) at simulated times (n,)."""
        states = self.at(t_s)
        Ts = np.tile(np.eye(4), (len(t_s), 1, 1))
        Ts[:, :3, :3] = rotations(states[:, 3:])
        Ts[:, :3, 3] = states[:, :3]
        return Ts


def as_state(T_grasp_tcp: Array) -> Array:
    """(6,) position in m and rotation vector in rad of a pose (4, 4)."""
    return np.concatenate([T_grasp_tcp[:3, 3], rotvec(T_grasp_tcp[:3, :3])])
