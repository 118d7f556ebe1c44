"""What is kept of a trial: one row, and on request the whole course for replay."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from backend import __version__
from backend.errors import InvalidInputError
from backend.events import TimedEvent
from backend.files import replacing
from backend.pipeline.values import CycleResult, FailureReason, Outcome
from backend.pose import Array, Pose
from backend.scenario import Scenario

TRACE_FORMAT = 1


@dataclass(frozen=True)
class TrialRecord:
    """One row per trial."""

    scenario: str
    robot: str
    task: str
    object: str
    method: str
    seed: int
    profile: str
    think: str
    strict: bool
    authors: bool
    reason: FailureReason | None
    detail: str
    approach_start_s: float | None
    lift_end_s: float | None
    end_s: float
    cycles: int
    cycle_mean_ms: float | None
    cycle_p95_ms: float | None
    joint_path_rad: float
    """Length of the way the arm really went in joint space."""
    fingerprint: str
    """Hash of the whole course of arm and object, and of the outcome."""
    version: str

    def as_dict(self) -> dict[str, object]:
        return asdict(self)


class Recorder:
    """Collects a trial while it runs."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario = scenario
        self.seed = seed
        self.events: list[TimedEvent] = []
        self.cycle_s: list[float] = []
        self._hash = hashlib.sha256()
        self._rows: list[Array] = []
        self._outcome: Outcome | None = None
        self._end_s = 0.0
        self._approach_start_s: float | None = None
        self._lift_end_s: float | None = None

    def tick(self, t_s: float, q: Array, T_world_object: Pose) -> None:
        """Keep where arm and object are."""
        row = np.concatenate([[t_s], q, T_world_object.xyz_m, T_world_object.wxyz])
        self._hash.update(row.tobytes())
        self._rows.append(row)

    def cycle(self, result: CycleResult) -> None:
        """Keep how long a cycle took."""
        self.cycle_s.append(sum(result.room_s.values()))

    def event(self, timed: TimedEvent) -> None:
        """Keep a live edit."""
        self.events.append(timed)

    def lifted(self, t_s: float) -> None:
        """The lift is over."""
        self._lift_end_s = t_s

    def end(self, outcome: Outcome, t_s: float, approach_start_s: float | None) -> None:
        """The trial is over."""
        self._outcome = outcome
        self._end_s = t_s
        self._approach_start_s = approach_start_s
        self._hash.update(repr((outcome.strict, outcome.authors, outcome.reason)).encode())

    def fingerprint(self) -> str:
        """16 hexadecimal digits that differ when any tick of the trial differs."""
        return self._hash.hexdigest()[:16]

    def record(self) -> TrialRecord:
        """The trial as a row; only for a trial that has ended."""
        outcome = self._outcome
        assert outcome is not None, "the trial has not ended"
        q = np.array([row[1:-7] for row in self._rows]).reshape(len(self._rows), -1)
        cycle_ms = 1e3 * np.array(self.cycle_s)
        scenario = self.scenario
        return TrialRecord(
            scenario=scenario.title,
            robot=scenario.robot,
            task=scenario.task.kind,
            object=scenario.object,
            method=scenario.method.name,
            seed=self.seed,
            profile=scenario.profile,
            think=scenario.timing.think,
            strict=outcome.strict,
            authors=outcome.authors,
            reason=outcome.reason,
            detail=outcome.detail,
            approach_start_s=self._approach_start_s,
            lift_end_s=self._lift_end_s,
            end_s=self._end_s,
            cycles=len(self.cycle_s),
            cycle_mean_ms=float(cycle_ms.mean()) if cycle_ms.size else None,
            cycle_p95_ms=float(np.percentile(cycle_ms, 95)) if cycle_ms.size else None,
            joint_path_rad=float(np.linalg.norm(np.diff(q, axis=0), axis=1).sum()),
            fingerprint=self.fingerprint(),
            version=__version__,
        )

    def save_trace(self, path: Path) -> None:
        """Write the whole trial as one compressed file, atomically; raises ``InvalidInputError`` if it can't."""
        edited = self.scenario.model_copy(update={"events": tuple(self.events), "seed": self.seed})
        header = {"format": TRACE_FORMAT, "scenario": edited.model_dump(mode="json")}
        header["record"] = self.record().as_dict()
        try:
            with replacing(path) as file:
                np.savez_compressed(file, header=np.array(json.dumps(header)), rows=np.array(self._rows))
        except OSError as error:
            raise InvalidInputError(f"Cannot write the trace to {path}: {error.strerror}.") from error


@dataclass(frozen=True, eq=False)
class Trace:
    """A recorded trial, as read from a file."""

    scenario: Scenario
    record: dict[str, object]
    rows: Array
    """(n, 1 + dof + 7): t_s, q, object position and wxyz, one row per tick."""


def load_trace(path: Path) -> Trace:
    """Read a trace; raises ``InvalidInputError`` for a file that is not one."""
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(str(file["header"]))
            rows = np.asarray(file["rows"], dtype=np.float64)
    except FileNotFoundError:
        raise InvalidInputError(f"There is no trace file {path}.") from None
    except (OSError, ValueError, KeyError, EOFError) as error:
        hint = "Traces are written by `python -m backend trial ... --trace FILE`."
        raise InvalidInputError(f"{path} is not a trace of a trial ({error}). {hint}") from error
    if header.get("format") != TRACE_FORMAT:
        raise InvalidInputError(f"{path}: trace format {header.get('format')}; this reads {TRACE_FORMAT}.")
    scenario = Scenario.model_validate_json(json.dumps(header["scenario"]))
    return Trace(scenario, header["record"], rows)
