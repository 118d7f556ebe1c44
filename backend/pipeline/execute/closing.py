"""Closing: when the fingers have stopped on something, or have had their time."""

CLOSE_AT_MOST_S = 1.2
"""The fingers have met whatever they will meet by then."""
STALLED_RPS = 0.02
"""Slower than this, closing fingers press on something."""
STALLED_FOR_S = 0.1


class Closing:
    """Watches the master joint of a hand that began to close at ``begun_s``."""

    def __init__(self, begun_s: float, shortest_s: float, finger_rad: float) -> None:
        self._begun_s = begun_s
        self._shortest_s = shortest_s
        self._finger_rad = finger_rad
        self._stalled_since_s: float | None = None

    def over(self, t_s: float, dt_s: float, finger_rad: float) -> bool:
        """Whether the hand may be taken for closed, ``dt_s`` after the last call, its master at ``finger_rad``."""
        moving = abs(finger_rad - self._finger_rad) > STALLED_RPS * dt_s
        self._finger_rad = finger_rad
        since = self._stalled_since_s
        self._stalled_since_s = None if moving else (t_s if since is None else since)
        closing_s = t_s - self._begun_s
        stalled = self._stalled_since_s is not None and t_s - self._stalled_since_s >= STALLED_FOR_S
        return closing_s >= self._shortest_s and (stalled or closing_s >= CLOSE_AT_MOST_S)
