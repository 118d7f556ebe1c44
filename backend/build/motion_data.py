"""Gathers attempts of one hand at one moving object: drawn from (seed, index) alone, resumable, over processes.

The hand alone, as in section IV-C of the paper: it starts at the pregrasp, goes in and closes as it does in a trial,
while the object moves straight on in a random direction. Besides the database's grasps, which mostly hold, grasps
around them are tried, so that there are failures to learn from.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from backend.build.attempts import Attempts, joined, read_attempts, save_attempts
from backend.build.digests import rig_digest
from backend.build.rig import Rig
from backend.errors import InvalidInputError, SimulationError
from backend.files import cache_folder
from backend.knowledge.grasps import GraspDatabase
from backend.objects import load_object
from backend.parallel import spread
from backend.pose import Array, Pose
from backend.robots.models import load_model

OnProgress = Callable[[str], None]
CHUNK = 250
"""Attempts in a file; at most so many are lost when a process is killed."""


class Ended(Protocol):
    """How an attempt ended."""

    @property
    def held(self) -> bool: ...

    @property
    def why(self) -> str: ...


class AttemptRig(Protocol):
    """One hand and one object; each attempt in a fresh world; same arguments, same outcome."""

    def attempt(
        self,
        T_object_grasp: Pose,
        T_believed_object: Pose | None = None,
        velocity_mps: Array | None = None,
    ) -> Ended:
        """Try a grasp, with the true object at ``T_believed_object`` in the frame where it is believed to be, on a
        belt that moves with ``velocity_mps`` (2,) in that frame."""
        ...


RigMaker = Callable[[str, str], AbstractContextManager[AttemptRig]]
"""From the names of robot and object; a function at the top of a module, so that it reaches other processes."""


def make_rig(robot: str, object: str) -> AbstractContextManager[AttemptRig]:
    """The simulated hand and object."""
    return Rig(load_model(robot), load_object(object))


@dataclass(frozen=True)
class GraspChoice:
    """One way to choose grasps: how often, and how far from those of the database."""

    share: float
    position_std_m: float
    """Of each coordinate of the tcp, in its own frame; with no deviation at all the grasp is tried as it is."""
    rotation_std_rad: float
    """Of roll, pitch and yaw of the tcp in its own frame."""


@dataclass(frozen=True)
class AttemptSettings:
    """What attempts are drawn from."""

    speeds_mps: tuple[float, float] = (0.005, 0.05)
    """The object's speed, uniform; the paper's range."""
    choices: tuple[GraspChoice, ...] = (
        GraspChoice(0.40, 0.0, 0.0),
        GraspChoice(0.35, 0.005, 0.09),
        GraspChoice(0.25, 0.015, 0.30),
    )
    """Shares add up to 1."""
    misplaced_m: float = 0.005
    """The true object is uniformly up to so far in x and y from where it is believed: what sensing and prediction
    leave when the hand goes in."""
    misplaced_rad: float = 0.09


@dataclass(frozen=True, eq=False)
class Case:
    """One attempt before it is made."""

    index: int
    grasp: int
    variant: int
    T_object_grasp: Pose
    misplaced: Array
    """(3,) x, y (m), yaw (rad)."""
    velocity_mps: Array
    """(2,)."""

    @property
    def T_believed_object(self) -> Pose:
        return Pose.from_xyz_yaw((*self.misplaced[:2], 0.0), float(self.misplaced[2]))


@dataclass(frozen=True, eq=False)
class Source:
    """Where attempts come from: everything that decides what a chunk holds."""

    robot: str
    object: str
    Ts_object_grasp: Array
    """(n, 4, 4) the database's."""
    seed: int
    settings: AttemptSettings
    make_rig: RigMaker = make_rig

    @property
    def folder(self) -> Path:
        """Of the chunks made from exactly this."""
        return cache_folder() / "attempts" / self.robot / f"{self.object}-{self.digest()}"

    def digest(self) -> str:
        """Of grasps, settings, seed, the shapes of hand and object, and the code of the attempt."""
        digest = hashlib.sha256(json.dumps([self.seed, asdict(self.settings), CHUNK]).encode())
        digest.update(f"{self.make_rig.__module__}.{self.make_rig.__qualname__}".encode())
        digest.update(np.ascontiguousarray(self.Ts_object_grasp).tobytes())
        digest.update(rig_digest(self.robot, self.object).encode())
        return digest.hexdigest()[:16]


def source_of(database: GraspDatabase, seed: int, settings: AttemptSettings | None = None) -> Source:
    """Attempts at a database's grasps."""
    return Source(database.robot, database.object, database.Ts_object_grasp, seed, settings or AttemptSettings())


def gather(source: Source, count: int, workers: int, on_progress: OnProgress) -> Attempts:
    """Attempts 0 to ``count`` - 1. Those in files are read, the others made; same source and count, same attempts.

    Raises ``InvalidInputError`` when there are no grasps, or none are asked for.
    """
    if count < 1 or len(source.Ts_object_grasp) < 1:
        raise InvalidInputError(f"Attempts need a grasp and a count (got {len(source.Ts_object_grasp)} and {count})")
    folder = source.folder
    spans = [(first, min(first + CHUNK, count)) for first in range(0, count, CHUNK)]
    kept = {span: read_attempts(chunk_file(folder, span), *span) for span in spans}
    parts = [part for part in kept.values() if part is not None]
    missing = [(source, folder, span) for span, part in kept.items() if part is None]
    if parts and missing:
        on_progress(f"{sum(map(len, parts))} of {count} attempts are there already")
    begun_s, made = time.perf_counter(), 0
    for part in spread(_make_chunk, missing, max(min(workers, len(missing)), 1)):
        parts.append(part)
        made += len(part)
        on_progress(_progress(parts, count, made / max(time.perf_counter() - begun_s, 1e-9)))
    return joined(parts)


def chunk_file(folder: Path, span: tuple[int, int]) -> Path:
    """Where the attempts from the first number of ``span`` up to the second are kept."""
    return folder / f"{span[0]:06d}-{span[1]:06d}.npz"


def draw(source: Source, index: int) -> Case:
    """Attempt number ``index``; no other draw has a part in it."""
    s = source.settings
    rng = np.random.default_rng([source.seed, index])
    grasp = int(rng.integers(len(source.Ts_object_grasp)))
    chosen = s.choices[int(rng.choice(len(s.choices), p=[one.share for one in s.choices]))]
    shift, turn = rng.normal(0.0, 1.0, (2, 3))
    off = Pose.from_xyz_rpy(shift * chosen.position_std_m, turn * chosen.rotation_std_rad)
    as_it_is = chosen.position_std_m == 0.0 and chosen.rotation_std_rad == 0.0
    speed, direction = rng.uniform(*s.speeds_mps), rng.uniform(-np.pi, np.pi)
    return Case(
        index=index,
        grasp=grasp,
        variant=0 if as_it_is else index + 1,
        T_object_grasp=Pose(source.Ts_object_grasp[grasp]) @ off,
        misplaced=draw_misplaced(s, rng),
        velocity_mps=speed * np.array([np.cos(direction), np.sin(direction)]),
    )


def draw_misplaced(settings: AttemptSettings, rng: np.random.Generator, *count: int) -> Array:
    """(3,), or (count, 3), x, y (m) and yaw (rad) of the true object in the frame where it is believed to be."""
    return rng.uniform(-1.0, 1.0, (*count, 3)) * [settings.misplaced_m, settings.misplaced_m, settings.misplaced_rad]


def attempted(rig: AttemptRig, case: Case) -> tuple[bool, str]:
    """Whether the object was held, and how it ended; a world that broke down has not held it."""
    try:
        ended = rig.attempt(case.T_object_grasp, case.T_believed_object, case.velocity_mps)
    except SimulationError as error:
        return False, str(error)
    return ended.held, "held" if ended.held else ended.why


def columns(cases: list[Case], ends: list[tuple[bool, str]]) -> Attempts:
    """Cases and how they ended, by column."""
    return Attempts(
        index=np.array([case.index for case in cases], dtype=np.int64),
        grasp=np.array([case.grasp for case in cases], dtype=np.int64),
        variant=np.array([case.variant for case in cases], dtype=np.int64),
        Ts_object_grasp=np.array([case.T_object_grasp.matrix for case in cases]).reshape(-1, 4, 4),
        misplaced=np.array([case.misplaced for case in cases]).reshape(-1, 3),
        velocity_mps=np.array([case.velocity_mps for case in cases]).reshape(-1, 2),
        held=np.array([held for held, _ in ends], dtype=np.bool_),
        why=np.array([why for _, why in ends], dtype=np.str_),
    )


Work = tuple[Source, Path, tuple[int, int]]


def _make_chunk(work: Work) -> Attempts:
    """Make the attempts of one span and keep them."""
    source, folder, span = work
    cases = [draw(source, index) for index in range(*span)]
    with source.make_rig(source.robot, source.object) as rig:
        made = columns(cases, [attempted(rig, case) for case in cases])
    save_attempts(made, chunk_file(folder, span))
    return made


def _progress(parts: list[Attempts], count: int, rate: float) -> str:
    done = sum(map(len, parts))
    share = sum(int(part.held.sum()) for part in parts) / done
    left_s = (count - done) / rate
    return f"{done} of {count} attempts, {share:.2f} held, {rate:.1f}/s, {left_s / 60.0:.0f} min to go"
