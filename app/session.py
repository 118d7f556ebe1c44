"""Session: the server's side of the simulation process; starts it, watches it, knows its last reports."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import threading
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any, Literal

from app.commands import Command, Restart, SetPaused
from app.engine import Engine, TrialInfo
from app.reports import Crashed, Pace, Progress, Refused, Report, Started, Traces
from app.worker import run_process
from backend.errors import GraspingError
from backend.snapshot import Snapshot

Status = Literal["starting", "running", "crashed"]


class SimulationDownError(GraspingError):
    """A command for a simulation process that has crashed."""


@dataclass(frozen=True, eq=False)
class SessionState:
    """Everything the page and the API may know, at one moment."""

    status: Status
    info: TrialInfo
    """What was asked for last."""
    restart: Restart
    """The command that asked for it."""
    loading: bool
    """A new episode was asked for and has not begun."""
    pace: Pace
    started: Started | None = None
    snapshot: Snapshot | None = None
    """Newest tick of the running episode; its ``cycle`` is filled in."""
    traces: Traces | None = None
    """Of the newest cycle."""
    crash: Crashed | None = None
    refusals: tuple[int, str] = (0, "")
    """How many commands were refused so far, and what was said to the last."""


class Session:
    """One simulation process at a time; a crash is a state, not an exception."""

    def __init__(self, engine: Engine, first: Restart, paused: bool = False) -> None:
        """Raises ``GraspingError`` when ``first`` cannot be run. Starts nothing."""
        self.engine = engine
        self._lock = threading.Condition()
        self._sending = threading.Lock()
        self._process: SpawnProcess | None = None
        self._link: Connection | None = None
        self._reader: threading.Thread | None = None
        self._ending = False
        pace = Pace(paused, 1.0, 0.0)
        self._state = SessionState("starting", engine.describe(first), first, loading=True, pace=pace)

    @property
    def state(self) -> SessionState:
        return self._state

    def next_snapshot(self, seen: Snapshot | None, timeout_s: float) -> SessionState:
        """The state as soon as it has another snapshot than ``seen``, or after ``timeout_s``."""
        with self._lock:
            self._lock.wait_for(lambda: self._state.snapshot is not seen, timeout_s)
            return self._state

    @property
    def process_id(self) -> int | None:
        """Of the simulation process; None before the start."""
        return self._process.pid if self._process else None

    def start(self) -> None:
        """Spawn the simulation process for the last asked trial."""
        context = multiprocessing.get_context("spawn")
        self._link, far_end = context.Pipe()
        arguments = (far_end, self.engine, self._state.restart, self._state.pace)
        self._ending = False
        self._process = context.Process(target=run_process, args=arguments, name="simulation", daemon=True)
        self._process.start()
        far_end.close()
        watched = (self._link, self._process)
        self._reader = threading.Thread(target=self._watch, args=watched, name="session", daemon=True)
        self._reader.start()

    def send(self, command: Command) -> None:
        """Check and pass on; a ``Restart`` of a crashed simulation starts a new process.

        Raises ``GraspingError`` when the restart cannot be run, ``SimulationDownError`` when nobody is there
        to obey.
        """
        if isinstance(command, Restart):
            info = self.engine.describe(command)
            self._change(info=info, restart=command, loading=True)
            if self._state.status == "crashed":
                self._revive()
                return
        if self._state.status == "crashed" or self._link is None:
            raise SimulationDownError("The simulation process is not running: restart it first.")
        if isinstance(command, SetPaused):
            self._change(pace=replace(self._state.pace, paused=command.paused))
        try:
            with self._sending:
                self._link.send(command)
        except OSError:
            raise SimulationDownError("The simulation process has just ended: restart it first.") from None

    def close(self) -> None:
        """End the simulation process; harmless when it is gone already."""
        if self._link is None or self._process is None or self._reader is None:
            return
        self._ending = True
        with contextlib.suppress(OSError):
            self._link.send(None)
        self._process.join(2.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._reader.join(2.0)
        self._link.close()

    def _revive(self) -> None:
        self.close()
        self._change(status="starting", crash=None, started=None, snapshot=None, traces=None)
        self.start()

    def _watch(self, link: Connection, process: SpawnProcess) -> None:
        """Take in every report until the process ends; runs in a thread of its own."""
        last_words: Crashed | None = None
        try:
            while True:
                report: Report = link.recv()
                if isinstance(report, Crashed):
                    last_words = report
                else:
                    self._take_in(report)
        except (EOFError, OSError):
            process.join()
        if not self._ending:
            crash = last_words or Crashed(_cause_of_end(process.exitcode), "")
            self._change(status="crashed", crash=crash, loading=False)

    def _take_in(self, report: Report) -> None:
        match report:
            case Started():
                self._change(
                    status="running",
                    started=report,
                    snapshot=None,
                    traces=None,
                    loading=self._is_stale(report),
                )
            case Progress():
                self._take_in_progress(report)
            case Pace():
                self._change(pace=report)
            case Refused(text=text):
                self._change(refusals=(self._state.refusals[0] + 1, text), loading=False, status="running")
            case Crashed():
                pass

    def _is_stale(self, started: Started) -> bool:
        """Whether something else has been asked for since."""
        return started.restart != self._state.restart

    def _take_in_progress(self, report: Progress) -> None:
        snapshot, old = report.snapshot, self._state.snapshot
        if snapshot.cycle is None and old is not None and old.cycle is not None:
            snapshot = replace(snapshot, cycle=old.cycle)
        self._change(snapshot=snapshot, traces=report.traces or self._state.traces)

    def _change(self, **fields: Any) -> None:
        with self._lock:
            self._state = replace(self._state, **fields)
            self._lock.notify_all()


def _cause_of_end(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        name = signal.Signals(-exit_code).name
        return f"The simulation process was ended by {name}: killed from outside or crashed natively."
    return f"The simulation process ended by itself with exit code {exit_code}."
