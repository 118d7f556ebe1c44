"""SharedView: what everybody who watches is shown alike, and whether the next trial begins by itself."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, ConfigDict, Field

from backend.config import Config
from backend.knowledge.reach_profile import HIGHEST_M, GraspKind

LayerName = Literal[
    "Conveyor", "Robot", "Object", "Obstacles", "Prediction", "All grasps", "Grasps", "Plans", "Hand trail", "Reach"
]
"""Titles of the page's ``LAYERS``, in their order."""
Score = Literal["Rank", "Reachability", "Quality in motion", "Lift success"]
"""What grasps can be coloured by, in the order of the page's ``SCORES``."""


def in_order(names: Collection[str]) -> tuple[LayerName, ...]:
    """Each layer once, in the order of ``LayerName``."""
    return tuple(name for name in get_args(LayerName) if name in names)


def _without_defaults(schema: dict[str, Any]) -> None:
    """In a change, what is not given stays as it is, and becomes no default."""
    for field in schema["properties"].values():
        field.pop("default", None)


class SharedView(Config):
    """What every page shows alike; camera, light or dark, and help are each browser's own.

    As a change of the view, only what is given counts.
    """

    model_config = ConfigDict(json_schema_extra=_without_defaults)

    auto_next: bool = True
    """Go on with the next seed 4 s after an outcome."""
    grasps_by: Score = "Rank"
    """What the small hands are coloured by."""
    grasp: Annotated[int, Field(ge=0, le=999)] | None = None
    """Number of the grasp whose card is shown; null for none."""
    hidden: Annotated[tuple[LayerName, ...], Field(strict=False), AfterValidator(in_order)] = ("Reach",)
    """Layers of the scene that are not shown."""
    reach_of: GraspKind = "From above"
    """Grasps that the slice through the arm's reach is for."""
    reach_height_m: Annotated[float, Field(ge=0.0, le=HIGHEST_M)] = 0.1
    """Of the slice, above the floor."""

    def changed(self, change: SharedView) -> SharedView:
        """This view with what was given to ``change`` in place of its own."""
        return self.model_copy(update=change.model_dump(exclude_unset=True))

    def with_layer(self, name: str, shown: bool) -> SharedView:
        """This view with one layer shown or hidden."""
        others = {other for other in self.hidden if other != name}
        return self.model_copy(update={"hidden": in_order(others if shown else {*others, name})})
