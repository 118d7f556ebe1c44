"""Touch: what clicks and drags in the scene ask for."""

from __future__ import annotations

from typing import Protocol

import viser

from app.commands import ApplyEvent
from app.ui.desk import Answer, Desk, checked
from backend.events import MoveObstacle


class Touch(Protocol):
    """Given to every layer."""

    def may(self, client: viser.ClientHandle) -> bool:
        """Whether this browser drives; one that does not is told so."""
        ...

    def grasp(self, index: int, client: viser.ClientHandle) -> None:
        """Show the card of a grasp."""
        ...

    def obstacle(self, index: int, x_m: float, y_m: float, yaw_rad: float, client: viser.ClientHandle) -> None:
        """Put an obstacle elsewhere in the running trial."""
        ...


class Untouched:
    """Where nobody can click."""

    def may(self, client: viser.ClientHandle) -> bool:
        return False

    def grasp(self, index: int, client: viser.ClientHandle) -> None:
        pass

    def obstacle(self, index: int, x_m: float, y_m: float, yaw_rad: float, client: viser.ClientHandle) -> None:
        pass


class DeskTouch:
    """Like a panel's callbacks it only leaves wishes."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def may(self, client: viser.ClientHandle) -> bool:
        return self._desk.admits(client)

    def grasp(self, index: int, client: viser.ClientHandle) -> None:
        self._desk.wish("grasp", lambda: self._desk.change_view(grasp=index), client)

    def obstacle(self, index: int, x_m: float, y_m: float, yaw_rad: float, client: viser.ClientHandle) -> None:
        self._desk.wish("obstacle", lambda: self._move(index, x_m, y_m, yaw_rad), client)

    def _move(self, index: int, x_m: float, y_m: float, yaw_rad: float) -> Answer:
        event = checked(MoveObstacle, index=index, x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
        self._desk.send(ApplyEvent(event=event))
        return f"Obstacle {index + 1} moved to {100 * x_m:.0f}, {100 * y_m:.0f} cm in the running trial."
