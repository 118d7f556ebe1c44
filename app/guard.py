"""Guard: who may talk to this server. Host, Origin and token are checked before all else."""

from __future__ import annotations

import hmac
import ipaddress
import socket
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.settings import Settings, is_loopback

COOKIE = "grasping_token"


@dataclass(frozen=True)
class Hosts:
    """By which names this server may be asked for: any other may be a foreign one, resolved to this machine."""

    names: frozenset[str]
    addresses: bool
    """Any IP address will do: no foreign name is one."""

    @property
    def refusal(self) -> str:
        also = " and to IP addresses" if self.addresses else ""
        return f"This server answers to {', '.join(sorted(self.names))}{also} only; add names with --host-names."

    def include(self, header: str) -> bool:
        """``header`` as in Host, port included."""
        try:
            name = urlsplit("//" + header).hostname or ""
        except ValueError:
            return False
        return name in self.names or (self.addresses and _is_address(name))


def hosts_of(settings: Settings) -> Hosts:
    """On a loopback address this machine's own names; else its name, its addresses, and what the settings add."""
    added = {name.strip().lower() for name in settings.host_names.split(",") if name.strip()}
    if is_loopback(settings.host):
        return Hosts(frozenset({"localhost", "127.0.0.1", "::1", *added}), addresses=False)
    own = socket.gethostname().lower()
    return Hosts(frozenset({"localhost", own, f"{own}.local", settings.host.lower(), *added}), addresses=True)


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class Guard:
    """ASGI middleware around the whole application."""

    def __init__(self, app: ASGIApp, *, token: str | None, hosts: Hosts) -> None:
        self._app = app
        self._token = token
        self._hosts = hosts

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
        if not self._hosts.include(headers.get("host", "")):
            return _refusal(403, self._hosts.refusal)
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
    return origin is not None and origin not in {f"{scheme}://{headers.get('host')}" for scheme in ("http", "https")}
