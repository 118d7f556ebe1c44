"""Taking a trial along: its permalink opened, its scenario, trace and outcome downloaded."""

from __future__ import annotations

import html
import json
from collections.abc import Callable
from threading import Lock

from fastapi import APIRouter
from fastapi.requests import Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from app.engine import Keepsake
from app.people import NEWCOMER
from app.permalink import PATH, trial_at
from app.session import Session
from app.ui.replay import replay_html
from backend.errors import GraspingError, NotFoundError
from backend.scenario import to_toml

VISITOR_COOKIE = "grasping_visitor"
"""Set by the page's own script: the key of the page that this browser has open."""
NOT_OVER = "The trial has not ended yet: there is something to download when it has."


def open_router(session: Session) -> APIRouter:
    """GET /open: where permalinks lead; POST when somebody else drives and is to drive no longer."""
    router = APIRouter()
    people = session.people

    @router.get(PATH, include_in_schema=False)
    def open_trial(request: Request) -> Response:
        """Only for somebody who goes there: no other page may let an image or a frame restart the trial."""
        if request.headers.get("sec-fetch-dest", "document") != "document":
            return _sorry("A link to a trial is opened as a page of its own.", 403)
        page_beside = people.known(request.cookies.get(VISITOR_COOKIE, ""))
        driver = people.driver
        if driver is None or driver in (page_beside, NEWCOMER):
            return begin(request)
        why = f"{driver.name} drives just now, and this link would restart what everybody sees."
        return _sorry(why, 409, "Somebody else drives", _form("Take control and open it"))

    @router.post(PATH, include_in_schema=False)
    def take_and_open(request: Request) -> Response:
        """The page that is about to open drives."""
        return begin(request)

    def begin(request: Request) -> Response:
        try:
            session.send(trial_at(dict(request.query_params)))
        except GraspingError as error:
            return _sorry(str(error), 404 if isinstance(error, NotFoundError) else 422)
        people.take(NEWCOMER)
        return RedirectResponse("/viewer/", status_code=303)

    return router


def share_router(session: Session) -> APIRouter:
    """Files of the running trial under /session."""
    router = APIRouter(tags=["session"])
    one_at_a_time = Lock()

    @router.get("/session/scenario.toml", response_class=Response)
    def scenario_file() -> Response:
        """The running trial as a scenario file: settings, seed and live edits."""
        state = session.state
        update = {"seed": state.restart.seed, "events": (*_own_events(session), *state.events)}
        text = to_toml(state.info.values.model_copy(update=update))
        return _file(text.encode(), "application/toml", f"{_name(session)}.toml")

    @router.get("/session/trace.npz", response_class=Response)
    def trace(compared: bool = False) -> Response:
        """The course of the trial, or of the one compared with, for `python -m backend replay`; 404 before its end."""
        return _of_keepsake(session, compared, lambda left: left.trace, "application/octet-stream", "npz")

    @router.get("/session/outcome.json", response_class=Response)
    def outcome(compared: bool = False) -> Response:
        """The row of the trial, or of the one compared with; 404 before its end."""
        return _of_keepsake(session, compared, _row, "application/json", "json")

    @router.get("/session/replay.html", response_class=Response)
    def replay() -> Response:
        """The last minute of the trial, to be played by any browser without this server."""
        state, moments = session.state, session.history.moments()
        if state.started is None or not moments:
            raise NotFoundError("There is nothing to replay yet.")
        with one_at_a_time:
            return _file(replay_html(state, state.started, moments).encode(), "text/html", f"{_name(session)}.html")

    return router


def _row(left: Keepsake) -> bytes:
    return json.dumps(left.record, indent=1).encode()


def _own_events(session: Session) -> tuple[object, ...]:
    """Those of the scenario's file, without those that the restart added."""
    values, added = session.state.info.values, len(session.state.restart.events)
    return values.events[: len(values.events) - added]


def _of_keepsake(
    session: Session, compared: bool, part: Callable[[Keepsake], bytes], media_type: str, ending: str
) -> Response:
    state = session.state
    left, sight = (state.keepsake_beside, state.beside) if compared else (state.keepsake, state)
    if left is None:
        snapshot = None if sight is None else sight.snapshot
        over = snapshot is not None and snapshot.outcome is not None
        raise NotFoundError(f"Nothing was kept of this trial. {state.refusals[1]}" if over else NOT_OVER)
    return _file(part(left), media_type, f"{_name(session)}{'_compared' if compared else ''}.{ending}")


def _name(session: Session) -> str:
    """For a file: what the scenario is called, of harmless characters only."""
    restart = session.state.restart
    stem = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "_" for c in restart.scenario)
    return f"{stem}_seed{restart.seed}"


def _file(content: bytes, media_type: str, name: str) -> Response:
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-store"}
    return Response(content, media_type=media_type, headers=headers)


def _form(label: str) -> str:
    """HTML of a button that posts to the address of its own page."""
    return f'<form method="post"><button>{html.escape(label)}</button></form>'


def _sorry(text: str, status: int, heading: str = "This link cannot be opened", way_out: str = "") -> HTMLResponse:
    page = (
        '<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        '<title>Dynamic grasping</title><link rel="stylesheet" href="/assets/page.css">'
        f'<main class="sorry"><h1>{html.escape(heading)}</h1>'
        f'<p class="why">{html.escape(text)}</p>{way_out}'
        '<p><a href="/viewer/">Open the dashboard as it is</a></p></main>'
    )
    return HTMLResponse(page, status_code=status)
