"""Report: a run's tables and figures, worked out by ``python -m backend report`` beside the server, and kept."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.runs.process import ROOT, BusyError
from backend.errors import GraspingError
from backend.experiments.grid.settings import JudgeName

LIMIT_S = 300.0
NICENESS = 5


@dataclass(frozen=True)
class Kept:
    """A report that was made."""

    rows: int
    """How many there were."""
    judge: JudgeName
    report: dict[str, Any]


class Reports:
    """One is made at a time; the last of each run is kept."""

    def __init__(self) -> None:
        self._making = threading.Lock()
        self._kept: dict[str, Kept] = {}
        self._process: subprocess.Popen[str] | None = None
        self._closed = False

    def close(self) -> None:
        """Give up the one that is being made."""
        self._closed = True
        if self._process is not None:
            self._process.kill()

    def report(self, run: Path, judge: JudgeName, rows: int) -> Kept:
        """The report of a run that has so many rows; raises ``GraspingError`` with what went wrong, ``BusyError``."""
        kept = self._kept.get(run.name)
        if kept is not None and (kept.rows, kept.judge) == (rows, judge):
            return kept
        if not self._making.acquire(timeout=1.0):
            raise BusyError("Another report is being made; ask again in a moment.")
        try:
            made = Kept(rows, judge, self._made(run, judge))
        finally:
            self._making.release()
        self._kept[run.name] = made
        return made

    def _made(self, run: Path, judge: JudgeName) -> dict[str, Any]:
        with tempfile.TemporaryDirectory(prefix="grasping-report-") as folder:
            command = [sys.executable, "-m", "backend", "report", str(run), "--judge", judge, "--to", folder, "--json"]
            errors, code = self._run(command)
            if code != 0:
                raise GraspingError(errors.strip().removeprefix("report: ") or "The report could not be made.")
            return json.loads((Path(folder) / "report.json").read_text())

    def _run(self, command: list[str]) -> tuple[str, int]:
        """What it said on stderr, and its exit code."""
        process = subprocess.Popen(
            command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        self._process = process
        if self._closed:
            process.kill()
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, process.pid, NICENESS)
        try:
            _, errors = process.communicate(timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise GraspingError(
                f"The report was not ready after {LIMIT_S:g} s; make it with `python -m backend report`."
            ) from None
        finally:
            self._process = None
        return errors, process.returncode
