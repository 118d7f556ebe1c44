"""OBJECTS: every object by name, in the order of the paper's figure, and which of them serve as obstacles."""

from functools import cache

from backend.errors import lookup
from backend.objects.bottles import bleach_cleanser, mustard_bottle
from backend.objects.boxes import cube, sugar_box
from backend.objects.cans import potted_meat_can, tomato_soup_can
from backend.objects.description import MakeObject, ObjectDescription
from backend.objects.mesh import Mesh
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


@cache
def load_object(name: str) -> ObjectDescription:
    """The object of that name, made once per user; raises ``NotFoundError`` naming what exists."""
    return stored(name, lookup("object", name, OBJECTS))


__all__ = ["OBJECTS", "OBSTACLES", "MakeObject", "Mesh", "ObjectDescription", "load_object"]
