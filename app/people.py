"""People: who is looking at the one simulation, and which of them drives it."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from backend.errors import GraspingError

LEASE_S = 10.0
"""Whoever drives without a page open has driven when nothing has come from there for so long."""


class NotDrivingError(GraspingError):
    """A command of somebody who only watches; says who drives, and how to take over."""


@dataclass(frozen=True)
class Visitor:
    """An open page; or one of the two below, which have none."""

    name: str
    key: str = field(default_factory=lambda: secrets.token_urlsafe(12), repr=False)
    """Known to that page only, which says it with what it asks of the API."""


SCRIPT = Visitor("A script", key="")
"""Whatever comes through the API without a page's key."""
NEWCOMER = Visitor("Somebody who has just opened a link", key="")
"""Keeps the wheel for the page that is about to open."""
LEASED = (SCRIPT, NEWCOMER)


class People:
    """One drives, the others watch. Safe to be asked from any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """``clock`` gives seconds from any origin."""
        self._clock = clock
        self._lock = threading.Lock()
        self._visitors: list[Visitor] = []
        self._driver: Visitor | None = None
        self._count = 0
        self._lease_ends_s = 0.0

    @property
    def driver(self) -> Visitor | None:
        """Who drives; None when whoever asks next may."""
        with self._lock:
            return self._current()

    @property
    def visitors(self) -> int:
        """How many pages are open."""
        with self._lock:
            return len(self._visitors)

    @property
    def watching(self) -> int:
        """How many of them do not drive."""
        with self._lock:
            return len(self._visitors) - (self._current() in self._visitors)

    def arrive(self) -> Visitor:
        """A page has opened; it drives when nobody does, or when the wheel was kept for it."""
        with self._lock:
            self._count += 1
            visitor = Visitor(f"Visitor {self._count}")
            self._visitors.append(visitor)
            if self._current() in (None, NEWCOMER):
                self._driver = visitor
            return visitor

    def leave(self, visitor: Visitor) -> None:
        """Its page has closed."""
        with self._lock:
            if visitor in self._visitors:
                self._visitors.remove(visitor)
            if self._driver is visitor:
                self._driver = None

    def known(self, key: str) -> Visitor | None:
        """The open page that has this key."""
        with self._lock:
            said = key.encode()
            return next((one for one in self._visitors if secrets.compare_digest(one.key.encode(), said)), None)

    def may(self, who: Visitor) -> bool:
        """Whether ``who`` drives, or would by asking for something."""
        with self._lock:
            return self._current() in (None, who)

    def admit(self, who: Visitor) -> None:
        """Let ``who`` drive when nobody else does; raises ``NotDrivingError`` when somebody does."""
        with self._lock:
            driver = self._current()
            if driver is not None and driver != who:
                raise NotDrivingError(
                    f"{driver.name} drives and you watch. To drive yourself, press Take control on the page, "
                    "or POST to /api/v1/session/driver."
                )
            self._seat(who)

    def take(self, who: Visitor) -> None:
        """Let ``who`` drive, whoever drove before."""
        with self._lock:
            self._seat(who)

    def release(self, who: Visitor) -> None:
        """``who`` drives no longer; nothing when he did not."""
        with self._lock:
            if self._driver is who:
                self._driver = None

    def _seat(self, who: Visitor) -> None:
        self._driver = who
        self._lease_ends_s = self._clock() + LEASE_S

    def _current(self) -> Visitor | None:
        """A lease may be over by now; the only page there is needs not ask."""
        if self._driver in LEASED and self._clock() >= self._lease_ends_s:
            self._driver = None
        if self._driver is None and len(self._visitors) == 1:
            self._driver = self._visitors[0]
        return self._driver
