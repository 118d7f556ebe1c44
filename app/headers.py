"""Headers: what every answer tells a browser not to allow."""

from __future__ import annotations

import secrets

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send


def new_nonce() -> str:
    """Marks the scripts of our own pages; another one whenever the server starts."""
    return secrets.token_urlsafe(16)


def policy(nonce: str) -> str:
    """The Content-Security-Policy: nothing from elsewhere, and no script that is not the page's own.

    viser compiles WebAssembly, runs its connection in a worker made of a blob, and sets styles as it goes. What it
    sorts Gaussian splats with would need eval; there are none here. A route may set a policy of its own.
    """
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src 'self' 'nonce-{nonce}' 'wasm-unsafe-eval' blob:",
            "worker-src 'self' blob:",
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' data: blob:",
            "font-src 'self' data:",
            "connect-src 'self' data: blob:",
            "form-action 'self'",
            "base-uri 'none'",
            "frame-ancestors 'none'",
        )
    )


class SafeHeaders:
    """ASGI middleware around everything, refusals included."""

    def __init__(self, app: ASGIApp, *, nonce: str) -> None:
        self._app = app
        self._headers = {
            "Content-Security-Policy": policy(nonce),
            "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY",
            "Referrer-Policy": "same-origin",  # with none at all, browsers keep the Origin of our own forms back
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_safely(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, send_safely)
