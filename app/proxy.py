"""viser behind FastAPI on one port: its page at /viewer/, its websocket at /viewer."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import html
from collections.abc import Coroutine
from pathlib import Path

import viser
from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from fastapi.requests import Request
from fastapi.responses import RedirectResponse, Response
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from app.inbound import is_allowed

LARGEST_MESSAGE_BYTES = 50 * 1024 * 1024
GOING_AWAY = 1001
TRY_AGAIN_LATER = 1013


def viewer_router(viser_port: int, title: str, max_clients: int) -> APIRouter:
    """Routes that serve viser's page and relay its websocket to ``127.0.0.1:viser_port``."""
    router = APIRouter()
    page = _page(title)
    zipped = gzip.compress(page, 6)
    relay = Relay(viser_port, max_clients)

    @router.get("/", include_in_schema=False)
    @router.get("/viewer", include_in_schema=False)
    def landing() -> Response:
        return RedirectResponse("/viewer/")

    @router.get("/viewer/", include_in_schema=False)
    def viewer(request: Request) -> Response:
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(zipped, media_type="text/html", headers={"Content-Encoding": "gzip"})
        return Response(page, media_type="text/html")

    @router.websocket("/viewer")
    async def viewer_socket(browser: WebSocket) -> None:
        await relay.serve(browser)

    return router


class Relay:
    """Carries messages between browsers and viser, the browsers' ones checked."""

    def __init__(self, viser_port: int, max_clients: int) -> None:
        self._address = f"ws://127.0.0.1:{viser_port}"
        self._max_clients = max_clients
        self._clients = 0

    async def serve(self, browser: WebSocket) -> None:
        """Relay until either side closes."""
        protocols = [Subprotocol(name) for name in browser.scope["subprotocols"]]
        if self._clients >= self._max_clients:
            await browser.accept(subprotocol=protocols[0] if protocols else None)
            await browser.close(TRY_AGAIN_LATER, f"At most {self._max_clients} browsers at a time.")
            return
        self._clients += 1
        try:
            await self._relay(browser, protocols)
        finally:
            self._clients -= 1

    async def _relay(self, browser: WebSocket, protocols: list[Subprotocol]) -> None:
        viser_side = connect(
            self._address,
            subprotocols=protocols,
            max_size=LARGEST_MESSAGE_BYTES,
            compression=None,
            proxy=None,
        )
        try:
            async with viser_side as upstream:
                await browser.accept(subprotocol=upstream.subprotocol)
                with contextlib.suppress(ConnectionClosed):
                    await _first_of(_outbound(upstream, browser), _inbound(browser, upstream))
                await browser.close(GOING_AWAY, "The viewer has ended this connection.")
        except WebSocketDisconnect:
            return
        except (OSError, WebSocketException):
            await browser.close(TRY_AGAIN_LATER, "The viewer is not running.")


async def _outbound(upstream: ClientConnection, browser: WebSocket) -> None:
    async for message in upstream:
        assert isinstance(message, bytes)
        await browser.send_bytes(message)


async def _inbound(browser: WebSocket, upstream: ClientConnection) -> None:
    while True:
        message = await browser.receive_bytes()
        if is_allowed(message):
            await upstream.send(message)


async def _first_of(*directions: Coroutine[None, None, None]) -> None:
    """Run both directions until one ends, then end the other; raises what the first one raised."""
    tasks = [asyncio.ensure_future(direction) for direction in directions]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def _page(title: str) -> bytes:
    """viser's single-file client under our title and icon, with our script beside it."""
    path = Path(viser.__file__).parent / "client" / "build" / "index.html"
    text = path.read_text(encoding="utf-8")
    head = (
        f'<title>{html.escape(title)}</title><link rel="icon" type="image/svg+xml" href="/assets/icon.svg">'
        '<script defer src="/assets/page.js"></script>'
    )
    return text.replace("<title>Viser</title>", head).encode()
