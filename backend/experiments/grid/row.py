"""GridRow: what is kept of one trial of a grid."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from backend.experiments.grid.cells import Job, Key

MEASURED = frozenset({"cycle_mean_ms", "cycle_p95_ms", "wall_s", "finished", "machine", "attempts"})
"""Columns that may differ when the same trial is run again; all others must not."""


@dataclass(frozen=True)
class GridRow:
    """One trial; the first six columns are its key."""

    settings: str
    """Hash of the grid's settings."""
    robot: str
    task: str
    object: str
    method: str
    index: int
    seed: int
    strict: bool
    authors: bool
    reason: str | None
    """Why ``strict`` is False; ``error`` for a trial that could not be run twice."""
    detail: str
    approach_start_s: float | None
    lift_end_s: float | None
    end_s: float | None
    """Simulated time at which the trial was over; None for an error."""
    cycles: int
    cycle_mean_ms: float | None
    cycle_p95_ms: float | None
    joint_path_rad: float | None
    distance_m: float | None
    """Of the belt from the robot's base (r in the paper)."""
    speed_mps: float | None
    """Mean speed of the belt; on the sinusoid, along its axis."""
    start: str
    """Hash of how the trial began; equal for paired trials."""
    fingerprint: str
    """Hash of the whole course and the outcome; empty for an error."""
    wall_s: float | None
    attempts: int
    """1, or 2 when the first failed to come to an end."""
    code: str
    machine: str
    finished: str
    """UTC, ISO 8601."""

    @property
    def key(self) -> Key:
        return Key(self.robot, self.task, self.object, self.method, self.index)

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)

    def sure(self) -> dict[str, Any]:
        """What must be the same whenever and wherever the trial is run with the same code."""
        return {name: value for name, value in self.as_dict().items() if name not in MEASURED}


COLUMNS = tuple(field.name for field in fields(GridRow))


def error_row(settings: str, job: Job, why: str, code: str, machine: str, finished: str) -> GridRow:
    """The row of a trial that crashed, hung or raised, and did so again."""
    return GridRow(
        settings=settings,
        **asdict(job.key),
        seed=job.seed,
        strict=False,
        authors=False,
        reason="error",
        detail=why,
        approach_start_s=None,
        lift_end_s=None,
        end_s=None,
        cycles=0,
        cycle_mean_ms=None,
        cycle_p95_ms=None,
        joint_path_rad=None,
        distance_m=None,
        speed_mps=None,
        start="",
        fingerprint="",
        wall_s=None,
        attempts=2,
        code=code,
        machine=machine,
        finished=finished,
    )
