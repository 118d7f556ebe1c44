"""Guard: who may talk to this server. Host, Origin and token are checked before all else."""

from __future__ import annotations

import hmac
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

COOKIE = "grasping_token"


class Guard:
    """ASGI middleware around the whole application."""

    def __init__(self, app: ASGIApp, *, token: str | None, loopback: bool) -> None:
        self._app = app
        self._token = token
        self._loopback = loopback  # the server listens on this machine only: honest requests name it

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        answer = self._objection(scope)
        if answer is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})  # before accept: answered as 403
        else:
            await answer(scope, receive, send)

    def _objection(self, scope: Scope) -> Response | None:
        headers = Headers(scope=scope)
        if self._loopback and not _names_this_machine(headers.get("host", "")):
            return _refusal(403, "This server answers to localhost and 127.0.0.1 only.")
        if _is_foreign(headers):
            return _refusal(403, "This page was asked for by another site.")
        if self._token is None or self._is_known(headers):
            return None
        query = parse_qsl(scope["query_string"].decode("latin-1"))
        if scope["type"] == "http" and self._fits(dict(query).get("token", "")):
            return self._welcome(scope["path"], [(name, value) for name, value in query if name != "token"])
        return _refusal(401, "A token is needed: open this page once with ?token=... behind its address.")

    def _is_known(self, headers: Headers) -> bool:
        bearer = headers.get("authorization", "").removeprefix("Bearer ")
        return self._fits(bearer) or self._fits(_cookie(headers.get("cookie", "")))

    def _fits(self, offered: str) -> bool:
        return hmac.compare_digest(offered.encode(), (self._token or "").encode())

    def _welcome(self, path: str, query: list[tuple[str, str]]) -> Response:
        """Put the token into a cookie and take it out of the address bar."""
        answer = RedirectResponse(path + ("?" + urlencode(query) if query else ""), status_code=303)
        answer.set_cookie(COOKIE, self._token or "", httponly=True, samesite="strict")
        return answer


def _refusal(status: int, text: str) -> Response:
    return JSONResponse({"error": text}, status_code=status)


def _cookie(header: str) -> str:
    try:
        morsel = SimpleCookie(header).get(COOKIE)
    except CookieError:
        return ""
    return morsel.value if morsel else ""


def _is_foreign(headers: Headers) -> bool:
    """Whether a browser says that a page of another host sent this; no Origin means no browser page did."""
    origin = headers.get("origin")
    return origin is not None and urlsplit(origin).netloc != headers.get("host")


def _names_this_machine(host: str) -> bool:
    """``host`` as in the Host header, port included; guards against a foreign name resolved to 127.0.0.1."""
    return (urlsplit("//" + host).hostname or "") in ("localhost", "127.0.0.1", "::1")
