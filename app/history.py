"""History: the last minute of the running trial, moment by moment."""

from __future__ import annotations

import threading
from bisect import bisect_left
from dataclasses import dataclass

from app.reports import Sight, Traces
from backend.snapshot import Snapshot

KEPT_S = 60.0


@dataclass(frozen=True, eq=False)
class Moment:
    """A tick that was reported; its cycle is the newest of then."""

    snapshot: Snapshot
    traces: Traces | None
    beside: Sight | None = None
    """The world compared with."""

    @property
    def newest(self) -> Snapshot:
        """Of the world that has come furthest: one may have ended before the other."""
        return newest(self.snapshot, self.beside)

    @property
    def t_s(self) -> float:
        return self.newest.t_s

    @property
    def tick(self) -> int:
        return self.newest.tick


def newest(snapshot: Snapshot, beside: Sight | None) -> Snapshot:
    """That of the later tick, ``snapshot`` where they are in step."""
    return snapshot if beside is None or beside.snapshot.tick <= snapshot.tick else beside.snapshot


class History:
    """Written by the session's thread, read by the dashboard's."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._moments: list[Moment] = []

    def add(self, moment: Moment) -> None:
        """The newest moment; what is older than a minute goes, and so does the same tick before an edit."""
        with self._lock:
            if self._moments and self._moments[-1].tick == moment.tick:
                self._moments.pop()
            self._moments.append(moment)
            oldest_s = moment.t_s - KEPT_S
            if self._moments[0].t_s < oldest_s:
                del self._moments[: bisect_left(self._moments, oldest_s, key=_time_s)]

    def clear(self) -> None:
        """Another trial has begun."""
        with self._lock:
            self._moments.clear()

    def cut(self, tick: int) -> None:
        """Forget what came after this tick."""
        with self._lock:
            self._moments = [moment for moment in self._moments if moment.tick <= tick]

    def at(self, t_s: float) -> Moment | None:
        """The kept moment nearest to a simulated time; None when nothing is kept."""
        with self._lock:
            i = bisect_left(self._moments, t_s, key=_time_s)
            near = self._moments[max(i - 1, 0) : i + 1]
        return min(near, key=lambda moment: abs(moment.t_s - t_s), default=None)

    def moments(self) -> tuple[Moment, ...]:
        """All that is kept, oldest first."""
        with self._lock:
            return tuple(self._moments)


def _time_s(moment: Moment) -> float:
    return moment.t_s
