"""The web application: viewer, API, and what is said when something goes wrong."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException

from app.api import api_router
from app.api.docs import docs_router
from app.api.experiments import experiments_router
from app.api.share import open_router
from app.guard import Guard, hosts_of
from app.headers import SafeHeaders, new_nonce
from app.people import NotDrivingError
from app.proxy import Relay, viewer_router
from app.runs.process import BusyError
from app.runs.runs import Runs
from app.session import Session
from app.settings import Settings
from app.state import SimulationDownError
from backend.errors import GraspingError, NotFoundError

TITLE = "Dynamic grasping"
DESCRIPTION = """\
Everything the page does, for scripts. One simulation is shared: whoever drives is obeyed, the others watch. Commands
without a page behind them count as one driver, a script; while a visitor drives they are answered with 409 until
`POST /api/v1/session/driver` takes control. A script gives it back with `DELETE`, or by sending nothing for 10 s.
"""
LARGEST_BODY_BYTES = 1024 * 1024
ASSETS = Path(__file__).resolve().parent.parent / "frontend_assets"


def create_app(session: Session, runs: Runs, settings: Settings, viser_port: int, viser_key: str) -> FastAPI:
    """The application in front of ``session`` and of the viser server on ``127.0.0.1:viser_port``."""
    nonce = new_nonce()
    app = FastAPI(
        title=TITLE,
        description=DESCRIPTION,
        version="1",
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        max_body_size=LARGEST_BODY_BYTES,
    )
    app.add_middleware(Guard, token=settings.token, hosts=hosts_of(settings))
    app.add_middleware(SafeHeaders, nonce=nonce)
    app.add_exception_handler(GraspingError, _explain_error)
    app.add_exception_handler(RequestValidationError, _explain_validation)
    app.add_exception_handler(HTTPException, _explain_status)
    relay = Relay(viser_port, viser_key, settings.max_clients)
    app.include_router(api_router(session, runs, relay))
    app.include_router(open_router(session))
    app.include_router(experiments_router())
    app.include_router(docs_router(ASSETS))
    app.include_router(viewer_router(relay, TITLE, nonce))
    app.mount("/assets", StaticFiles(directory=ASSETS), name="assets")
    return app


def _explain_error(_: Request, error: Exception) -> JSONResponse:
    """404 for what does not exist, 409 when it is down, busy or in other hands, 422 for what cannot be used."""
    statuses: dict[type[Exception], int] = {
        NotFoundError: 404,
        SimulationDownError: 409,
        BusyError: 409,
        NotDrivingError: 409,
    }
    return JSONResponse({"error": str(error)}, status_code=statuses.get(type(error), 422))


def _explain_status(_: Request, error: Exception) -> JSONResponse:
    """What the framework itself refuses, in the words that everything else is refused in."""
    assert isinstance(error, HTTPException)
    return JSONResponse({"error": str(error.detail)}, status_code=error.status_code, headers=error.headers)


def _explain_validation(_: Request, error: Exception) -> JSONResponse:
    """One line per complaint; the refused values themselves are not echoed, since NaN is no JSON."""
    assert isinstance(error, RequestValidationError)
    lines = [f"{'.'.join(str(part) for part in entry['loc'])}: {entry['msg']}" for entry in error.errors()]
    return JSONResponse({"error": "\n".join(lines)}, status_code=422)
