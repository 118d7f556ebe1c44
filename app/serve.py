"""Serve: session, dashboard and web server, started in this order and ended in the other."""

from __future__ import annotations

import contextlib
import signal
import socket
from collections.abc import Generator
from pathlib import Path
from types import FrameType
from urllib.parse import urlencode

import uvicorn

from app.backend_engine import BackendEngine
from app.commands import Restart
from app.engine import Engine
from app.inbound import LARGEST_MESSAGE_BYTES
from app.main import create_app
from app.runs.runs import Runs
from app.session import Session
from app.settings import Settings
from app.ui.dashboard import Dashboard

LARGEST_REQUEST_HEAD_BYTES = 128 * 1024
"""Links carry whole scenario files."""
ENDING = (signal.SIGINT, signal.SIGTERM)


def serve(settings: Settings, listener: socket.socket, engine: Engine | None = None) -> None:
    """Serve on the bound ``listener`` until interrupted.

    Raises ``GraspingError`` before anything starts when the first scenario cannot be run.
    """
    first = Restart(scenario=settings.scenario, seed=settings.seed, overrides={})
    session = Session(engine or BackendEngine(), first, settings.paused, settings.auto_next)
    session.start()
    try:
        dashboard = Dashboard(session, settings.low_fx, settings.tour)
        dashboard.start()
        try:
            with contextlib.closing(Runs(Path(settings.runs))) as runs:
                _serve_web(session, runs, dashboard, settings, listener)
        finally:
            dashboard.close()
    finally:
        session.close()


def _serve_web(session: Session, runs: Runs, dashboard: Dashboard, settings: Settings, listener: socket.socket) -> None:
    app = create_app(session, runs, settings, dashboard.server.get_port(), dashboard.key)
    config = uvicorn.Config(
        app,
        http="h11",
        h11_max_incomplete_event_size=LARGEST_REQUEST_HEAD_BYTES,
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        ws_max_size=LARGEST_MESSAGE_BYTES,
        log_level="warning",
        timeout_graceful_shutdown=2,
        server_header=False,
    )
    host, port = settings.host, listener.getsockname()[1]
    query = "?" + urlencode({"token": settings.token}) if settings.token else ""
    with contextlib.closing(listener), _interrupts_noted() as noted:
        print(f"Dashboard: http://{f'[{host}]' if ':' in host else host}:{port}/{query}", flush=True)
        print("Ctrl-C ends it.", flush=True)
        _Server(config, session, noted).run(sockets=[listener])
    if noted:
        raise KeyboardInterrupt


@contextlib.contextmanager
def _interrupts_noted() -> Generator[list[int]]:
    """Note interrupts instead of raising them: one amid the event loop's making or its end would wreck it.

    Blocking them in this thread would not do, since the system then gives them to another one.
    """
    noted: list[int] = []

    def note(number: int, _: FrameType | None) -> None:
        noted.append(number)

    before = {number: signal.signal(number, note) for number in ENDING}
    try:
        yield noted
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class _Server(uvicorn.Server):
    """Tells the session when it ends, and ends at once when it was told to before it could listen for that."""

    def __init__(self, config: uvicorn.Config, session: Session, noted: list[int]) -> None:
        super().__init__(config)
        self._session = session
        self._noted = noted

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """By now uvicorn listens for interrupts itself."""
        self.should_exit = self.should_exit or bool(self._noted)
        await super().startup(sockets)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Whoever waits for news is told that none will come."""
        self._session.closing.set()
        await super().shutdown(sockets)
