"""What tests ask of a session: to wait for a state of it, and its tick."""

import time
from collections.abc import Callable

from app.session import Session
from app.state import SessionState


def wait(session: Session, ready: Callable[[SessionState], bool], patience_s: float = 20.0) -> SessionState:
    """The state, once ``ready`` says yes to it."""
    deadline = time.monotonic() + patience_s
    while not ready(session.state):
        assert time.monotonic() < deadline, f"not reached; last state: {session.state}"
        time.sleep(0.01)
    return session.state


def tick(state: SessionState) -> int:
    """-1 before there is one."""
    return -1 if state.snapshot is None else state.snapshot.tick
