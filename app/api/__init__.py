"""The HTTP interface, version 1: what exists, what runs, commands to it, and grids."""

from fastapi import APIRouter
from pydantic import BaseModel

from app.api.control import control_router
from app.api.events import events_router
from app.api.health import health_router
from app.api.runs import runs_router
from app.api.scenarios import scenarios_router
from app.api.session import session_router
from app.api.share import share_router
from app.api.view import view_router
from app.proxy import Relay
from app.runs.runs import Runs
from app.session import Session


class Complaint(BaseModel):
    """Answer to what cannot be done."""

    error: str
    """What is wrong and where, or who drives and how to take over."""


def api_router(session: Session, runs: Runs, relay: Relay) -> APIRouter:
    """Everything under /api/v1."""
    router = APIRouter(prefix="/api/v1", responses={status: {"model": Complaint} for status in (404, 409, 422)})
    for part in (
        health_router(session, relay),
        scenarios_router(session.engine),
        session_router(session),
        view_router(session),
        control_router(session),
        events_router(session),
        share_router(session),
        runs_router(runs, session),
    ):
        router.include_router(part)
    return router
