"""GraspDatabase: how a hand can hold an object, and how often each grasp has held it in simulated lifts."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from backend.errors import InvalidInputError, MissingResourceError, lookup
from backend.files import data_folder, remove, replacing
from backend.objects import OBJECTS, object_names
from backend.pose import Array

Counts = NDArray[np.int64]
FORMAT = 1


@dataclass(frozen=True, eq=False)
class GraspDatabase:
    """Grasps of one object by one hand, best first."""

    robot: str
    object: str
    Ts_object_grasp: Array
    """(n, 4, 4) tcp in the object frame."""
    lifts: Counts
    """(n,) simulated lifts of each grasp."""
    successes: Counts
    """(n,) how many of them held."""
    facts: dict[str, Any] = field(default_factory=dict[str, Any])
    """How it was made: seed, settings, versions."""

    @property
    def quality(self) -> Array:
        """(n,) share of lifts that held."""
        return self.successes / self.lifts

    def __len__(self) -> int:
        return len(self.lifts)


def load_grasps(robot: str, object: str) -> GraspDatabase:
    """The database of a hand and an object.

    Raises ``NotFoundError`` for unknown names and ``MissingResourceError`` for a database not built yet.
    """
    _check_names(robot, object)
    path = grasp_file(robot, object)
    if not path.is_file():
        raise MissingResourceError(
            f"There are no grasps of {object} for {robot}: {path} is missing. "
            f"Make them with: python -m backend build grasps --robot {robot} --object {object}"
        )
    return read_grasps(path)


def read_grasps(path: Path) -> GraspDatabase:
    """A database from a file; raises ``InvalidInputError`` when the file is not one."""
    try:
        with np.load(path, allow_pickle=False) as data:
            facts = cast(dict[str, Any], json.loads(str(data["facts"])))
            if facts.get("format") != FORMAT:
                raise InvalidInputError(f"{path}: format {facts.get('format')}, this version reads {FORMAT}.")
            Ts, lifts, successes = data["Ts_object_grasp"], data["lifts"], data["successes"]
    except (OSError, ValueError, KeyError) as error:
        raise InvalidInputError(f"{path}: not a grasp database ({error}).") from error
    for array in (Ts, lifts, successes):
        array.flags.writeable = False
    return GraspDatabase(str(facts["robot"]), str(facts["object"]), Ts, lifts, successes, facts)


def save_grasps(database: GraspDatabase, path: Path | None = None) -> Path:
    """Write a database where ``load_grasps`` finds it, or to ``path``; all of it or nothing."""
    path = path or grasp_file(database.robot, database.object)
    facts = {**database.facts, "format": FORMAT, "robot": database.robot, "object": database.object}
    with replacing(path) as file:
        np.savez_compressed(
            file,
            Ts_object_grasp=database.Ts_object_grasp,
            lifts=database.lifts,
            successes=database.successes,
            facts=np.array(json.dumps(facts, sort_keys=True)),
        )
    return path


def remove_grasps(object: str) -> None:
    """Forget every hand's grasps of a user's object, as when it is no longer what it was.

    Raises ``InvalidInputError`` when a file cannot be removed.
    """
    assert object not in OBJECTS, "the project's databases stay"
    for path in (data_folder() / "grasps").glob(f"*/{object}.npz"):
        remove(path)


def grasp_file(robot: str, object: str) -> Path:
    """Where the database of that pair is kept: with the project, or with the user's own objects."""
    base = Path(__file__).parent.parent / "assets" if object in OBJECTS else data_folder()
    return base / "grasps" / robot / f"{object}.npz"


def _check_names(robot: str, object: str) -> None:
    from backend.robots import ROBOTS

    lookup("robot", robot, ROBOTS)
    lookup("object", object, dict.fromkeys(object_names()))
