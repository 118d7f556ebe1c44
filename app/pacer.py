"""Pacer: when the next tick is due, and how fast time has really passed."""

from __future__ import annotations

import time
from collections import deque

LARGEST_DEBT_S = 0.25
"""A simulation later than this forgets the lost time instead of racing after it."""
WINDOW_S = 1.0


class Pacer:
    """Simulated seconds against those of the wall."""

    def __init__(self, speed: float | None) -> None:
        self.speed = speed
        """Asked simulated seconds per second; None is as fast as it goes."""
        self._due_s = 0.0
        self._clock: deque[tuple[float, float]] = deque()

    def reset(self) -> None:
        """Begin to count anew: time that was not to pass is no debt."""
        self._due_s = time.perf_counter()
        self._clock.clear()

    def ticked(self, now_s: float, t_s: float, tick_s: float) -> None:
        """A tick of ``tick_s`` simulated seconds has led to ``t_s`` at ``now_s`` of the wall."""
        if self.speed is None:
            self._due_s = now_s
        else:
            self._due_s = max(self._due_s + tick_s / self.speed, now_s - LARGEST_DEBT_S)
        self._clock.append((now_s, t_s))
        while now_s - self._clock[0][0] > WINDOW_S:
            self._clock.popleft()

    def waits_s(self) -> float:
        """Until the next tick is due; 0 when it is."""
        return max(0.0, self._due_s - time.perf_counter())

    def real_time_factor(self) -> float:
        """Over the last second; 0 before two ticks."""
        if len(self._clock) < 2:
            return 0.0
        (wall_a, sim_a), (wall_b, sim_b) = self._clock[0], self._clock[-1]
        return (sim_b - sim_a) / max(wall_b - wall_a, 1e-9)
