"""GraspDatabase: how a hand can hold an object, and how often each grasp has held it in simulated lifts."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.knowledge.pairs import check_pair, pair_file
from backend.knowledge.shelf import Arrays, Label, read, write
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

    Raises ``NotFoundError`` for unknown names, ``MissingResourceError`` for a database not built yet, and
    ``InvalidInputError`` for a file that is something else.
    """
    check_pair(robot, object)
    return read_grasps(grasp_file(robot, object), robot, object)


def read_grasps(path: Path, robot: str, object: str) -> GraspDatabase:
    """The database of that pair from a file; errors as ``load_grasps``."""
    label = _label(robot, object)
    arrays, facts = read(path, label)
    try:
        Ts, lifts, successes = (arrays[name] for name in ("Ts_object_grasp", "lifts", "successes"))
    except KeyError as error:
        raise label.refusal(path, f"{error} is missing") from error
    return GraspDatabase(robot, object, Ts, lifts, successes, facts)


def save_grasps(database: GraspDatabase, path: Path | None = None) -> Path:
    """Write a database where ``load_grasps`` finds it, or to ``path``; all of it or nothing."""
    robot, object = database.robot, database.object
    arrays: Arrays = {
        "Ts_object_grasp": database.Ts_object_grasp,
        "lifts": database.lifts,
        "successes": database.successes,
    }
    return write(path or grasp_file(robot, object), _label(robot, object), arrays, database.facts)


def grasp_file(robot: str, object: str) -> Path:
    """Where the database of that pair is kept."""
    return pair_file("grasps", robot, object)


def _label(robot: str, object: str) -> Label:
    command = f"python -m backend build grasps --robot {robot} --object {object}"
    return Label(f"grasp database of {object} for {robot}", FORMAT, command, {"robot": robot, "object": object})
