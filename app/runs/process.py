"""Process: the one grid that the page runs, as ``python -m backend grid`` in a process of its own."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from backend.errors import GraspingError, NotFoundError

ROOT = Path(__file__).resolve().parents[2]
NICENESS = 5
"""The page goes before the grid where both want the same core."""
PATIENCE_S = 20.0
"""How long trials under way may take when the server ends; after that they are dropped."""
TAIL_BYTES = 4_000
DONE, STOPPED = 0, 1


class BusyError(GraspingError):
    """Something else has to end first."""


class GridProcess:
    """At most one at a time; used by several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._folder = tempfile.TemporaryDirectory(prefix="grasping-grid-")
        self._process: subprocess.Popen[bytes] | None = None
        self._name = ""
        self._stopping = False

    def start(self, run: Path, grid_file: str, trial_set: str | None, workers: int | None) -> None:
        """Begin or go on; raises ``BusyError`` while another grid of the page runs."""
        with self._lock:
            if self._alive():
                raise BusyError(f"The grid {self._name} is running; stop it first, or wait until it is done.")
            here = Path(self._folder.name)
            (here / "grid.toml").write_text(grid_file, encoding="utf-8")
            command = [sys.executable, "-m", "backend", "grid", str(here / "grid.toml"), "--out", str(run)]
            if trial_set is not None:
                (here / "trials.csv").write_text(trial_set, encoding="utf-8")
                command += ["--trials-file", str(here / "trials.csv")]
            if workers is not None:
                command += ["--workers", str(workers)]
            with open(here / "log", "wb") as log:
                self._process = subprocess.Popen(
                    command,
                    cwd=ROOT,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=log,
                    start_new_session=True,
                )
            with contextlib.suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, self._process.pid, NICENESS)
            self._name, self._stopping = run.name, False

    def stop(self, name: str) -> None:
        """Let the trials under way be the last; asked again, end at once. Raises ``NotFoundError``."""
        with self._lock:
            if not self._alive() or self._name != name or self._process is None:
                raise NotFoundError(f"The page runs no grid {name}; what a terminal started is ended there by Ctrl-C.")
            self._process.send_signal(signal.SIGTERM)
            self._stopping = True

    def stopping(self, name: str) -> bool:
        """Whether the run is about to end."""
        with self._lock:
            return self._stopping and self._name == name and self._alive()

    def runs(self, name: str) -> bool:
        """Whether the page runs it."""
        with self._lock:
            return self._name == name and self._alive()

    def last_words(self, name: str) -> str:
        """What the run said when it ended otherwise than by being done or stopped; empty otherwise."""
        with self._lock:
            ended = None if self._process is None or self._name != name else self._process.poll()
            if ended is None or ended in (DONE, STOPPED) or self._stopping:
                return ""
            with open(Path(self._folder.name) / "log", "rb") as log:
                log.seek(max(0, log.seek(0, os.SEEK_END) - TAIL_BYTES))
                text = log.read().decode(errors="replace").strip()
            return text or f"The grid ended with exit code {ended}."

    def close(self) -> None:
        """Let the trials under way finish, for a while; every row written is kept."""
        with self._lock:
            process = self._process
            if process is not None and self._alive():
                print(f"Finishing the trials under way of {self._name}; it can be gone on with.", flush=True)
                process.send_signal(signal.SIGTERM)
                if not _ended(process, PATIENCE_S):
                    process.send_signal(signal.SIGTERM)  # the second ends at once
                    if not _ended(process, PATIENCE_S):
                        os.killpg(process.pid, signal.SIGKILL)
                        process.wait()
            self._folder.cleanup()

    def _alive(self) -> bool:
        return self._process is not None and self._process.poll() is None


def _ended(process: subprocess.Popen[bytes], within_s: float) -> bool:
    try:
        process.wait(within_s)
    except subprocess.TimeoutExpired:
        return False
    return True
