"""Start viser, without what it would do unasked."""

from __future__ import annotations

import contextlib
import hmac
import io
import secrets
import warnings
from collections.abc import Generator
from http import HTTPStatus
from typing import Any

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

KEY_HEADER = "X-Viewer-Key"


def start_viser(key: str | None = None) -> viser.ViserServer:
    """viser on a free port of this machine, unable to open a tunnel to the outside, and silent.

    It would let in any page of any browser here; so it answers only to who brings ``key`` in ``KEY_HEADER``;
    to nobody without one.
    A browser that leaves in the midst of an answer is nothing to warn of.
    """
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    with contextlib.redirect_stdout(io.StringIO()), _locked(key or secrets.token_urlsafe()):
        server = viser.ViserServer(host="127.0.0.1", port=0, label="Dynamic grasping", verbose=False)
    server.request_share_url = _refuse_to_share
    return server


@contextlib.contextmanager
def _locked(key: str) -> Generator[None]:
    """viser has no setting for this, so the websocket server that it starts is wrapped."""
    serve = websockets.asyncio.server.serve

    def serve_known(*args: Any, process_request: Any, **options: Any) -> Any:
        def check(connection: ServerConnection, request: Request) -> Response | None:
            if not hmac.compare_digest(request.headers.get(KEY_HEADER, "").encode(), key.encode()):
                return connection.respond(HTTPStatus.FORBIDDEN, "This is not the dashboard's address.\n")
            return process_request(connection, request)

        return serve(*args, process_request=check, **options)

    websockets.asyncio.server.serve = serve_known
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve


def _refuse_to_share(verbose: bool = True) -> str | None:
    """Stands in for viser's own, which lets any client open a public tunnel."""
    return None
