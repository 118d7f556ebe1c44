"""Obstacles and slab: put up, taken away and hung higher in the running trial, and recorded with it."""

from __future__ import annotations

from typing import Any

import viser

from app.commands import ApplyEvent
from app.ui.desk import Answer, Desk, checked
from app.ui.panels.choice import choosing
from app.ui.panels.panel import View
from app.ui.placing import free_place
from backend.errors import InvalidInputError
from backend.events import AddObstacle, RemoveObstacle, SetSlab
from backend.objects import OBSTACLES, object_names
from backend.snapshot import Snapshot

CM_PER_M = 100.0
SLAB_CM = (10.0, 100.0)
USUAL_SLAB_CM = 40.0
SETTLE_S = 0.3
NONE = "none"


class ObstaclesPanel:
    """What acts at once; obstacles that stand there are also dragged in the scene."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        with gui.add_folder("Obstacles (act at once)", expand_by_default=False):
            kinds = (*OBSTACLES, *(name for name in object_names() if name not in OBSTACLES))
            self._kind = gui.add_dropdown("New", kinds, hint="What Add puts beside the belt")
            self._which: viser.GuiDropdownHandle[str] = gui.add_dropdown(
                "Standing", [NONE], hint="What Remove takes away"
            )
            self._buttons = gui.add_button_group(
                "Change", ("Add", "Remove"), hint="Add: beside the belt, then drag it in the scene"
            )
            self._slab = gui.add_checkbox("Slab", False, hint="Above the whole belt, 10 cm wide")
            self._height = gui.add_slider(
                "Slab, cm", *SLAB_CM, 1.0, USUAL_SLAB_CM, hint="From the tray to the slab's underside"
            )
        self._buttons.on_click(choosing(desk, "obstacle", self.press))
        self._slab.on_update(choosing(desk, "slab", self.set_slab))
        self._height.on_update(choosing(desk, "slab height", self._set_height, SETTLE_S))

    def show(self, view: View) -> None:
        snapshot = view.state.snapshot
        if snapshot is None:
            return
        standing = labels(snapshot) or (NONE,)
        if tuple(self._which.options) != standing:
            self._which.options = standing
            self._which.value = standing[-1]
        self._height.disabled = snapshot.slab is None
        self._desk.mirror("slab", self._slab, snapshot.slab is not None)
        height_m = height_of_slab_m(view)
        if height_m is not None:
            lowest, highest = SLAB_CM
            self._desk.mirror("slab height", self._height, min(max(round(CM_PER_M * height_m), lowest), highest))

    def press(self, label: str) -> Answer:
        """Add or remove what is chosen above the buttons."""
        return self.add(self._kind.value) if label == "Add" else self.remove(self._which.value)

    def add(self, name: str) -> Answer:
        """Put one up where there is room."""
        state = self._desk.session.state
        if state.started is None or state.newest is None:
            raise InvalidInputError("There is no trial yet to put an obstacle into.")
        x_m, y_m = free_place(state.started.scene, state.newest)
        self._send(AddObstacle, object=name, x_m=x_m, y_m=y_m)
        return (
            f"{name} put up at {CM_PER_M * x_m:.0f}, {CM_PER_M * y_m:.0f} cm in the running trial. It can be dragged."
        )

    def remove(self, label: str) -> Answer:
        """Take away the one of that label."""
        newest = self._desk.session.state.newest
        standing = () if newest is None else labels(newest)
        if label not in standing:
            raise InvalidInputError(f"There is no obstacle {label!r}. Standing: {', '.join(standing) or NONE}.")
        self._send(RemoveObstacle, index=standing.index(label))
        return f"{label} taken away in the running trial."

    def set_slab(self, wanted: bool) -> Answer:
        """Hang a slab above the belt, or take it away."""
        if wanted:
            return self._set_height(USUAL_SLAB_CM)
        self._send(SetSlab, height_m=None)
        return "Slab taken away in the running trial."

    def _set_height(self, height_cm: float) -> Answer:
        self._send(SetSlab, height_m=height_cm / CM_PER_M)
        return f"Slab hung {height_cm:.0f} cm above the tray in the running trial."

    def _send(self, kind: type[Any], **values: Any) -> None:
        self._desk.send(ApplyEvent(event=checked(kind, **values)))


def labels(snapshot: Snapshot) -> tuple[str, ...]:
    """What obstacles are called where one is chosen."""
    return tuple(f"{i} {name}" for i, name in enumerate(snapshot.obstacles, start=1))


def height_of_slab_m(view: View) -> float | None:
    """From the highest point of the tray's top to the slab's underside; None without a slab."""
    snapshot, started = view.state.snapshot, view.state.started
    if snapshot is None or started is None or snapshot.slab is None:
        return None
    underside_m = float(snapshot.slab.T_world_box.xyz_m[2]) - 0.5 * snapshot.slab.size_m[2]
    return underside_m - float(started.scene.belt_path_world[:, 2].max())
