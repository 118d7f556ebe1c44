"""Session: the server's side of the simulation process; starts it, watches it, knows its last reports."""

from __future__ import annotations

import contextlib
import multiprocessing
import threading
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

from app.commands import ApplyEvent, Command, GoOn, LookBack, Restart, SetPaused, StepOnce
from app.engine import Engine, TrialInfo
from app.history import History, Moment
from app.people import People
from app.reports import Crashed, Edited, Ended, Pace, Progress, Refused, Report, Sight, Started, filled_in
from app.state import SessionState, SimulationDownError, cause_of_end
from app.view import SharedView
from app.wanted import compared_with
from app.worker import run_process
from backend.errors import InvalidInputError


class Session:
    """One simulation process at a time; a crash is a state, not an exception."""

    def __init__(self, engine: Engine, first: Restart, paused: bool = False, auto_next: bool = True) -> None:
        """Raises ``GraspingError`` when ``first`` cannot be run. Starts nothing."""
        self.engine = engine
        self.people = People()
        self.closing = threading.Event()
        """Set when the server ends, for whoever waits for news."""
        self._lock = threading.Condition()
        self._sending = threading.Lock()
        self._process: SpawnProcess | None = None
        self._link: Connection | None = None
        self._reader: threading.Thread | None = None
        self._ending = False
        self.history = History()
        self._continued: Restart | None = None
        pace = Pace(paused, 1.0, 0.0)
        view = SharedView(auto_next=auto_next)
        self._state = SessionState("starting", engine.describe(first), first, loading=True, pace=pace, view=view)

    @property
    def state(self) -> SessionState:
        return self._state

    def next_tick(self, seen: SessionState | None, timeout_s: float) -> SessionState:
        """The state as soon as it has another tick than ``seen``, or after ``timeout_s``."""

        def is_new() -> bool:
            return seen is None or (seen.snapshot, seen.beside) != (self._state.snapshot, self._state.beside)

        with self._lock:
            self._lock.wait_for(is_new, timeout_s)
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
        match command:
            case LookBack(t_s=t_s):
                self._look_back(t_s)
                return
            case GoOn():
                self._go_on()
                return
            case Restart():
                info = self._described(command)
                self._change(info=info, restart=command, loading=True)
                if command is not self._continued:
                    self._change(looked_at=None)
                if self._state.status == "crashed":
                    self._revive()
                    return
            case ApplyEvent() if self._state.looked_at is not None:
                raise InvalidInputError("The past cannot be edited: go on from here first, or go back to the newest.")
            case StepOnce() | SetPaused(paused=False):
                self._change(looked_at=None)
            case _:
                pass
        self._pass_on(command)

    def change_view(self, change: Callable[[SharedView], SharedView]) -> SharedView:
        """The view that ``change`` makes of the one there is; no other change comes between."""
        with self._lock:
            self._change(view=change(self._state.view))
            return self._state.view

    def _described(self, restart: Restart) -> TrialInfo:
        """What would run; raises ``GraspingError`` when that, or what it is to be compared with, cannot."""
        compared = compared_with(restart)
        if compared is not None:
            self.engine.describe(compared)
        return self.engine.describe(restart)

    def _look_back(self, t_s: float | None) -> None:
        moment = None if t_s is None else self.history.at(t_s)
        if t_s is not None and moment is None:
            raise InvalidInputError("There is nothing to look back at yet.")
        if moment is not None and moment.newest is self._state.newest:
            moment = None
        if t_s is not None and not self._state.pace.paused:
            self._change(pace=replace(self._state.pace, paused=True))
            self._pass_on(SetPaused(paused=True))
        self._change(looked_at=moment)

    def _go_on(self) -> None:
        """Repeat the trial up to the moment looked at, and play on."""
        self._continued = self._state.gone_on_with()
        self.send(self._continued)
        self._pass_on(SetPaused(paused=False))

    def _pass_on(self, command: Command) -> None:
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
        self._change(status="starting", crash=None, started=None, snapshot=None, traces=None, beside=None)
        self._change(looked_at=None)
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
            crash = last_words or Crashed(cause_of_end(process.exitcode), "")
            self._change(status="crashed", crash=crash, loading=False)

    def _take_in(self, report: Report) -> None:
        match report:
            case Started():
                self._begin_history(report.restart)
                self._change(
                    status="running",
                    started=report,
                    snapshot=None,
                    traces=None,
                    beside=None,
                    events=report.restart.events,
                    keepsake=None,
                    keepsake_beside=None,
                    loading=report.restart != self._state.restart,  # something else was asked for since
                )
            case Progress():
                self._take_in_progress(report)
            case Edited(events=events):
                self._change(events=events)
            case Ended(keepsake=keepsake, beside=beside):
                self._change(**{"keepsake_beside" if beside else "keepsake": keepsake})
            case Pace():
                self._change(pace=report)
            case Refused(text=text):
                self._change(refusals=(self._state.refusals[0] + 1, text), loading=False, status="running")
            case Crashed():
                pass

    def _take_in_progress(self, report: Progress) -> None:
        old = self._state
        before = None if old.snapshot is None else Sight(old.snapshot, old.traces)
        now = filled_in(Sight(report.snapshot, report.traces), before)
        beside = None if report.beside is None else filled_in(report.beside, old.beside)
        self.history.add(Moment(now.snapshot, now.traces, beside))
        looked_at = None if before is None else old.looked_at
        self._change(snapshot=now.snapshot, traces=now.traces, beside=beside, looked_at=looked_at)

    def _begin_history(self, restart: Restart) -> None:
        """What was before the moment that is gone on from stays, since it comes out the same again."""
        if restart == self._continued:
            self.history.cut(restart.from_tick - 1)
        else:
            self.history.clear()
            self._continued = None

    def _change(self, **fields: Any) -> None:
        with self._lock:
            self._state = replace(self._state, **fields)
            self._lock.notify_all()
