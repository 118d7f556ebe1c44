"""Memory: the little that a browser remembers of this page from visit to visit."""

from __future__ import annotations

import viser

PREFIX = "grasping-"
PATIENCE_S = 5.0


class Memory:
    """Kept in the browser's own storage; one that keeps nothing is as one that comes for the first time."""

    def recall(self, client: viser.ClientHandle, key: str) -> str | None:
        """What was kept; None when there is nothing, or no answer. Waits, so not for the dashboard's thread."""
        try:
            return client.local_storage.get_item(PREFIX + key, timeout=PATIENCE_S)
        except (RuntimeError, TimeoutError):
            return None

    def keep(self, client: viser.ClientHandle, key: str, value: str) -> None:
        """Until the browser forgets it."""
        client.local_storage.set_item(PREFIX + key, value)
