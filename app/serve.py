"""Serve: session, dashboard and web server, started in this order and ended in the other."""

from __future__ import annotations

import contextlib
import signal
import socket
from pathlib import Path

import uvicorn

from app.backend_engine import BackendEngine
from app.commands import Restart
from app.engine import Engine
from app.main import create_app
from app.runs.runs import Runs
from app.session import Session
from app.settings import Settings
from app.ui.dashboard import Dashboard

LARGEST_MESSAGE_BYTES = 8 * 1024 * 1024
ENDING = (signal.SIGINT, signal.SIGTERM)


def serve(settings: Settings, listener: socket.socket, engine: Engine | None = None) -> None:
    """Serve on the bound ``listener`` until interrupted.

    Raises ``GraspingError`` before anything starts when the first scenario cannot be run.
    """
    first = Restart(scenario=settings.scenario, seed=settings.seed, overrides={})
    session = Session(engine or BackendEngine(), first, settings.paused)
    session.start()
    try:
        dashboard = Dashboard(session, settings.auto_next, settings.low_fx, settings.tour)
        dashboard.start()
        try:
            with contextlib.closing(Runs(Path(settings.runs))) as runs:
                _serve_web(session, runs, dashboard, settings, listener)
        finally:
            dashboard.close()
    finally:
        session.close()


def _serve_web(session: Session, runs: Runs, dashboard: Dashboard, settings: Settings, listener: socket.socket) -> None:
    app = create_app(session, runs, settings, dashboard.server.get_port())
    config = uvicorn.Config(
        app,
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        ws_max_size=LARGEST_MESSAGE_BYTES,
        log_level="warning",
        timeout_graceful_shutdown=2,
    )
    host, port = settings.host, listener.getsockname()[1]
    query = f"?token={settings.token}" if settings.token else ""
    print(f"Dashboard: http://{f'[{host}]' if ':' in host else host}:{port}/{query}", flush=True)
    print("Ctrl-C ends it.", flush=True)
    with contextlib.closing(listener):
        signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        _Server(config).run(sockets=[listener])


class _Server(uvicorn.Server):
    """Ends cleanly however early it is told to: an interrupt amid the event loop's making would wreck it."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """By now uvicorn listens for signals; those that came too early are delivered here."""
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        await super().startup(sockets)
