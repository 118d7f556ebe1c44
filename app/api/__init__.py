"""The HTTP interface, version 1: what exists, what runs, commands to it, and grids."""

from fastapi import APIRouter

from app.api.health import health_router
from app.api.runs import runs_router
from app.api.scenarios import scenarios_router
from app.api.session import session_router
from app.api.share import share_router
from app.runs.runs import Runs
from app.session import Session


def api_router(session: Session, runs: Runs) -> APIRouter:
    """Everything under /api/v1."""
    router = APIRouter(prefix="/api/v1")
    for part in (
        health_router(session),
        scenarios_router(session.engine),
        session_router(session),
        share_router(session),
        runs_router(runs, session),
    ):
        router.include_router(part)
    return router
