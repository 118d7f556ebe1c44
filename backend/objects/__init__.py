"""OBJECTS: the seven that come with the project, in the order of the paper's figure, and which serve as obstacles.

Users may bring their own. ``object_names`` and ``load_object`` know both; ``OBJECTS`` is meant where the paper's seven
are: surveys, the databases of the project, its measurements.
"""

from functools import cache

from backend.errors import NotFoundError, not_found_text
from backend.objects.bottles import bleach_cleanser, mustard_bottle
from backend.objects.boxes import cube, sugar_box
from backend.objects.cans import potted_meat_can, tomato_soup_can
from backend.objects.description import MakeObject, ObjectDescription
from backend.objects.mesh import Mesh
from backend.objects.own import load_own, own_names
from backend.objects.power_drill import power_drill
from backend.objects.store import stored

OBJECTS: dict[str, MakeObject] = {
    "bleach_cleanser": bleach_cleanser,
    "mustard_bottle": mustard_bottle,
    "potted_meat_can": potted_meat_can,
    "sugar_box": sugar_box,
    "tomato_soup_can": tomato_soup_can,
    "power_drill": power_drill,
    "cube": cube,
}

OBSTACLES = ("tomato_soup_can", "power_drill", "bleach_cleanser")


def object_names() -> tuple[str, ...]:
    """The seven, then the user's own by name."""
    return (*OBJECTS, *(name for name in own_names() if name not in OBJECTS))


def load_object(name: str) -> ObjectDescription:
    """The object of that name; raises ``NotFoundError`` naming what exists."""
    if name in OBJECTS:
        return _built_in(name)
    if name in own_names():
        return load_own(name)
    raise NotFoundError(not_found_text("object", name, object_names()))


@cache
def _built_in(name: str) -> ObjectDescription:
    return stored(name, OBJECTS[name])


__all__ = ["OBJECTS", "OBSTACLES", "MakeObject", "Mesh", "ObjectDescription", "load_object", "object_names"]
