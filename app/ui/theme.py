"""Theme: light or dark, each browser as it likes, and remembered by it."""

from __future__ import annotations

import viser

from app.ui.memory import Memory
from app.ui.rooms import lay_floor, set_theme

KEY = "dark"
LIGHT, DARK = "Light", "Dark"


class Theme:
    """Acts on one browser's own copy of the page only."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._dark: set[int] = set()

    def welcome(self, client: viser.ClientHandle) -> None:
        """What this browser chose when it was here last."""
        if self._memory.recall(client, KEY) == "1":
            self.choose(client, dark=True)

    def toggle(self, client: viser.ClientHandle) -> None:
        """The other one."""
        self.choose(client, dark=client.client_id not in self._dark)

    def choose(self, client: viser.ClientHandle, dark: bool) -> None:
        """Light or dark from now on."""
        (self._dark.add if dark else self._dark.discard)(client.client_id)
        with client.atomic():
            set_theme(client.gui, dark)
            lay_floor(client.scene, dark)
        self._memory.keep(client, KEY, "1" if dark else "0")
