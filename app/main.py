"""The web application: viewer, API, and what is said when something goes wrong."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.staticfiles import StaticFiles

from app.api import api_router
from app.api.experiments import experiments_router
from app.api.share import open_router
from app.guard import Guard
from app.proxy import viewer_router
from app.runs.process import BusyError
from app.runs.runs import Runs
from app.session import Session
from app.settings import Settings, is_loopback
from app.state import SimulationDownError
from backend.errors import GraspingError, NotFoundError

TITLE = "Dynamic grasping"
ASSETS = Path(__file__).resolve().parent.parent / "frontend_assets"


def create_app(session: Session, runs: Runs, settings: Settings, viser_port: int) -> FastAPI:
    """The application in front of ``session`` and of the viser server on ``127.0.0.1:viser_port``."""
    app = FastAPI(title=TITLE, docs_url="/api/docs", redoc_url=None, openapi_url="/api/openapi.json")
    app.add_middleware(Guard, token=settings.token, loopback=is_loopback(settings.host))
    app.add_exception_handler(GraspingError, _explain_error)
    app.add_exception_handler(RequestValidationError, _explain_validation)
    app.include_router(api_router(session, runs))
    app.include_router(open_router(session))
    app.include_router(experiments_router())
    app.include_router(viewer_router(viser_port, TITLE, settings.max_clients))
    app.mount("/assets", StaticFiles(directory=ASSETS), name="assets")
    return app


def _explain_error(_: Request, error: Exception) -> JSONResponse:
    """404 for what does not exist, 409 for what is down or busy, 422 for what cannot be used."""
    statuses: dict[type[Exception], int] = {NotFoundError: 404, SimulationDownError: 409, BusyError: 409}
    return JSONResponse({"error": str(error)}, status_code=statuses.get(type(error), 422))


def _explain_validation(_: Request, error: Exception) -> JSONResponse:
    """One line per complaint; the refused values themselves are not echoed, since NaN is no JSON."""
    assert isinstance(error, RequestValidationError)
    lines = [f"{'.'.join(str(part) for part in entry['loc'])}: {entry['msg']}" for entry in error.errors()]
    return JSONResponse({"error": "\n".join(lines)}, status_code=422)
