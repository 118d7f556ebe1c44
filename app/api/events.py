"""The event stream: what happens, as it happens, at a bounded rate."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, HTTPException, Query
from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import BaseModel

from app.api.control import control_state
from app.api.session import describe
from app.people import SCRIPT
from app.session import Session

MOST_STREAMS = 32
HEARTBEAT_S = 5.0
RETRY_MS = 2000
LONGEST_SLEEP_S = 0.2
"""So soon a stream notices that the server ends."""

Rate = Annotated[float, Query(ge=0.1, le=30.0, description="Most events of a kind per second.")]


def events_router(session: Session) -> APIRouter:
    """GET /events."""
    router = APIRouter(tags=["events"])
    open_streams = 0

    async def one_of_few() -> AsyncIterator[None]:
        nonlocal open_streams
        if open_streams >= MOST_STREAMS:
            raise HTTPException(429, f"At most {MOST_STREAMS} event streams at a time: close one.")
        open_streams += 1
        try:
            yield
        finally:
            open_streams -= 1

    @router.get("/events", response_class=EventSourceResponse, dependencies=[Depends(one_of_few)])
    async def events(rate_hz: Rate = 5.0) -> AsyncIterator[ServerSentEvent]:
        """Server-sent events: `state` (as /session), `view` (as /session/view) and `control` (as /session/driver).

        Each comes at first and when it has changed.

        Only the newest counts: what changes faster than `rate_hz` is not queued. A comment comes when nothing
        else has for 5 s. The stream ends when the server does.
        """
        async for event in changes(session, 1.0 / rate_hz):
            yield event

    return router


async def changes(
    session: Session, interval_s: float, heartbeat_s: float = HEARTBEAT_S
) -> AsyncIterator[ServerSentEvent]:
    """What is new since the last event, at most every ``interval_s``; ends once the session is closing."""
    said: dict[str, BaseModel] = {}
    number, due_s, heartbeat_due_s = 0, 0.0, 0.0
    while not session.closing.is_set():
        now_s = time.monotonic()
        if now_s >= due_s:
            due_s = now_s + interval_s
            state, control = session.state, control_state(session.people, SCRIPT)
            news = {"control": control, "state": describe(state), "view": state.view}
            for name, value in news.items():
                if said.get(name) != value:
                    said[name] = value
                    number += 1
                    heartbeat_due_s = now_s + heartbeat_s
                    yield ServerSentEvent(event=name, data=value, id=str(number), retry=RETRY_MS)
        if now_s >= heartbeat_due_s:
            heartbeat_due_s = now_s + heartbeat_s
            yield ServerSentEvent(comment="still here")
        await asyncio.sleep(min(interval_s, LONGEST_SLEEP_S))
