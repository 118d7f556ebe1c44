"""Attempts: simulated grasps of one hand at one moving object, and how each ended."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.files import replacing
from backend.pose import Array

Ids = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Attempts:
    """n attempts, by column."""

    index: Ids
    """(n,) of the draw; with the seed it decides everything about an attempt."""
    grasp: Ids
    """(n,) index of the database's grasp that was tried, or that was perturbed."""
    variant: Ids
    """(n,) 0 for a grasp as it is in the database; every perturbed grasp has a number of its own."""
    Ts_object_grasp: Array
    """(n, 4, 4) as tried, in the frame of the object where it is believed to be."""
    misplaced: Array
    """(n, 3) x, y (m) and yaw (rad) of the true object in the frame of the believed one."""
    velocity_mps: Array
    """(n, 2) of the belt, in the believed object's frame."""
    held: NDArray[np.bool_]
    """(n,)."""
    why: NDArray[np.str_]
    """(n,) how the attempt ended, in words."""

    def __len__(self) -> int:
        return len(self.index)

    @property
    def speed_mps(self) -> Array:
        """(n,)."""
        return np.linalg.norm(self.velocity_mps, axis=1)

    @property
    def direction_rad(self) -> Array:
        """(n,) of the motion, from the believed object's x axis."""
        return np.arctan2(self.velocity_mps[:, 1], self.velocity_mps[:, 0])

    def take(self, rows: NDArray[Any]) -> Attempts:
        """Some of them, by index or mask."""
        return Attempts(**{name: getattr(self, name)[rows] for name in COLUMNS})


COLUMNS = tuple(column.name for column in fields(Attempts))


def joined(parts: Sequence[Attempts]) -> Attempts:
    """All attempts of some parts, which must not be none, in order of their index."""
    columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS}
    together = Attempts(**columns)
    return together.take(np.argsort(together.index, kind="stable"))


def save_attempts(attempts: Attempts, path: Path) -> None:
    """Write them to a file; all of it or nothing."""
    with replacing(path) as file:
        np.savez_compressed(file, allow_pickle=False, **{name: getattr(attempts, name) for name in COLUMNS})


def read_attempts(path: Path, first: int, stop: int) -> Attempts | None:
    """The attempts ``first`` to ``stop`` - 1 from a file; None when there is no such file, or none that holds them."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            attempts = Attempts(**{name: data[name] for name in COLUMNS})
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
        return None
    whole = all(len(getattr(attempts, name)) == stop - first for name in COLUMNS)
    return attempts if whole and np.array_equal(attempts.index, np.arange(first, stop)) else None
