"""Choice: how a widget's callback becomes a wish at the desk."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

import viser

from app.ui.desk import Answer, Desk

SETTLE_S = 0.6
"""Typed numbers act when the typing has stopped for so long."""
Callback = Callable[[Any], Coroutine[None, None, None]]


def choosing(desk: Desk, key: str, act: Callable[[Any], Answer], after_s: float = 0.0) -> Callback:
    """A callback that leaves the wish to do ``act`` with the widget's value.

    It is a coroutine because viser calls those at once, and not some time later in a pool of threads.
    """

    async def on_event(event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:  # None: set by the panel itself
            value = event.target.value
            desk.wish(key, lambda: act(value), event.client, after_s)

    return on_event
