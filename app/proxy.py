"""viser behind FastAPI on one port: its page at /viewer/, its websocket at /viewer."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import html
import re
import time
from collections.abc import AsyncIterable, Coroutine
from pathlib import Path

import viser
from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from fastapi.requests import Request
from fastapi.responses import RedirectResponse, Response
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from app.inbound import is_allowed
from app.ui.start import KEY_HEADER

LARGEST_MESSAGE_BYTES = 50 * 1024 * 1024
GOING_AWAY = 1001
TRY_AGAIN_LATER = 1013
MOST_HZ = 300
"""Messages a second from one browser; of more it is heard later."""
BURST = 600
"""As many at once as a second or two of everything, before that holds."""
PATIENCE_S = 20.0
"""A browser that takes nothing for so long is given up."""
PROTOCOL = re.compile(r"viser-v[\w.+-]{1,40}")


def viewer_router(relay: Relay, title: str, nonce: str) -> APIRouter:
    """Routes that serve viser's page and its websocket.

    ``nonce`` marks the page's own scripts.
    """
    router = APIRouter()
    page = _page(title, nonce)
    zipped = gzip.compress(page, 6)

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


class DeafError(Exception):
    """A browser does not take what it is sent."""


class Relay:
    """Carries messages between browsers and viser, the browsers' ones checked."""

    def __init__(self, viser_port: int, viser_key: str, max_clients: int) -> None:
        """To ``127.0.0.1:viser_port``, which opens to ``viser_key``."""
        self._headers = {KEY_HEADER: viser_key}
        self._address = f"ws://127.0.0.1:{viser_port}"
        self.max_clients = max_clients
        self.clients = 0
        """Connected now."""

    async def serve(self, browser: WebSocket) -> None:
        """Relay until either side closes."""
        protocols = [Subprotocol(name) for name in browser.scope["subprotocols"] if PROTOCOL.fullmatch(name)]
        if self.clients >= self.max_clients:
            await browser.accept(subprotocol=protocols[0] if protocols else None)
            await browser.close(TRY_AGAIN_LATER, f"At most {self.max_clients} browsers at a time.")
            return
        self.clients += 1
        try:
            await self._relay(browser, protocols)
        finally:
            self.clients -= 1

    async def _relay(self, browser: WebSocket, protocols: list[Subprotocol]) -> None:
        viser_side = connect(
            self._address,
            subprotocols=protocols,
            additional_headers=self._headers,
            max_size=LARGEST_MESSAGE_BYTES,
            compression=None,
            proxy=None,
        )
        try:
            async with viser_side as upstream:
                await browser.accept(subprotocol=upstream.subprotocol)
                with contextlib.suppress(ConnectionClosed):
                    await _first_of(outbound(upstream, browser), _inbound(browser, upstream))
                await browser.close(GOING_AWAY, "The viewer has ended this connection.")
        except WebSocketDisconnect:
            return
        except DeafError:
            return  # not even a farewell would be taken
        except (OSError, WebSocketException):
            await browser.close(TRY_AGAIN_LATER, "The viewer is not running.")


async def outbound(upstream: AsyncIterable[str | bytes], browser: WebSocket, patience_s: float = PATIENCE_S) -> None:
    """Hand on what viser says; raises ``DeafError`` when the browser takes nothing for ``patience_s``."""
    async for message in upstream:
        assert isinstance(message, bytes)
        try:
            async with asyncio.timeout(patience_s):  # viser goes on with the newest once this is taken
                await browser.send_bytes(message)
        except TimeoutError:
            raise DeafError from None


async def _inbound(browser: WebSocket, upstream: ClientConnection) -> None:
    pace = Pace()
    while (message := await browser.receive())["type"] == "websocket.receive":
        raw = message.get("bytes")
        if raw is not None and is_allowed(raw):
            await upstream.send(raw)
        await pace.wait()
    raise WebSocketDisconnect(message.get("code", 1005))


class Pace:
    """Makes whoever sends too much wait, and nobody else."""

    def __init__(self) -> None:
        self._due_s = 0.0

    async def wait(self) -> None:
        """After each message."""
        debt_s = self.debt_s(time.monotonic())
        if debt_s > 0.0:
            await asyncio.sleep(debt_s)

    def debt_s(self, now_s: float) -> float:
        """Count a message at ``now_s``; how long the next is to wait."""
        self._due_s = max(self._due_s, now_s - BURST / MOST_HZ) + 1.0 / MOST_HZ
        return max(0.0, self._due_s - now_s)


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


def _page(title: str, nonce: str) -> bytes:
    """viser's single-file client under our title and icon, with our script beside it.

    It unpacks its main script from another one, so both get the nonce.
    """
    path = Path(viser.__file__).parent / "client" / "build" / "index.html"
    text = path.read_text(encoding="utf-8")
    head = (
        f'<title>{html.escape(title)}</title><link rel="icon" type="image/svg+xml" href="/assets/icon.svg">'
        '<script defer src="/assets/page.js"></script>'
    )
    for old, new in (
        ("<title>Viser</title>", head),
        ("<script data-p=", f'<script nonce="{nonce}" data-p='),
        ('e.type="module";', f'e.type="module";e.nonce="{nonce}";'),
    ):
        assert text.count(old) == 1, f"viser's page has changed: {old}"
        text = text.replace(old, new)
    return text.encode()
