"""What is known of one hand with one object: where it is kept, and how it is forgotten."""

from pathlib import Path
from typing import Literal

from backend.errors import lookup
from backend.files import data_folder, remove
from backend.knowledge.shelf import ASSETS
from backend.objects import OBJECTS, object_names

Kind = Literal["grasps", "motion_aware"]
KINDS: tuple[Kind, ...] = ("grasps", "motion_aware")


def pair_file(kind: Kind, robot: str, object: str) -> Path:
    """Where that is kept: with the project, or with the user's own objects."""
    base = ASSETS if object in OBJECTS else data_folder()
    return base / kind / robot / f"{object}.npz"


def check_pair(robot: str, object: str) -> None:
    """Raises ``NotFoundError`` for unknown names."""
    from backend.robots import ROBOTS

    lookup("robot", robot, ROBOTS)
    lookup("object", object, dict.fromkeys(object_names()))


def forget(object: str) -> None:
    """Remove all that any hand knows of a user's object, as when it is no longer what it was.

    Raises ``InvalidInputError`` when a file cannot be removed.
    """
    assert object not in OBJECTS, "what comes with the project stays"
    for kind in KINDS:
        for path in (data_folder() / kind).glob(f"*/{object}.npz"):
            remove(path)
