"""The simulation process: drains commands, advances the episode at wall pace, reports the newest snapshot."""

from __future__ import annotations

import signal
import sys
import time
import traceback
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing.connection import Connection

from app.commands import ApplyEvent, Command, GoOn, LookBack, Restart, SetPaused, SetSpeed, StepOnce
from app.engine import Engine, Running
from app.pacer import Pacer
from app.reports import Crashed, Edited, Ended, Pace, Progress, Refused, Report, Started, Traces, slim
from backend.errors import GraspingError
from backend.events import TimedEvent, WorldEvent
from backend.pipeline.values import CycleResult
from backend.snapshot import Snapshot

REPORT_INTERVAL_S = 1 / 40
"""Snapshots are reported at most this often on average; at real time there are 30 a second."""
LARGEST_BURST_S = 0.1
"""Ticks that a busy machine delivers late and together are all reported up to this delay."""
PACE_INTERVAL_S = 0.5


def run_process(link: Connection, engine: Engine, first: Restart, pace: Pace) -> None:
    """Entry point of the spawned process: Ctrl-C reaches the whole group, but the server decides."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    run_worker(link, engine, first, pace)


def run_worker(link: Connection, engine: Engine, first: Restart, pace: Pace) -> None:
    """Serve until the other end of ``link`` says None or closes; a crash is reported, then the exit code is 1."""
    try:
        Worker(link, engine, pace).serve(first)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    except Exception as error:
        link.send(Crashed(f"{type(error).__name__}: {error}", traceback.format_exc()))
        sys.exit(1)


class Worker:
    """Owns the one episode of its process."""

    def __init__(self, link: Connection, engine: Engine, pace: Pace) -> None:
        self._link = link
        self._engine = engine
        self._paused = pace.paused
        self._pacer = Pacer(pace.speed)
        self._run = 0
        self._episode: Running | None = None
        self._ticks: Iterator[Snapshot] = iter(())
        self._last: Snapshot | None = None
        self._made: tuple[TimedEvent, ...] = ()
        self._given: tuple[TimedEvent, ...] = ()
        self._from_tick = 0
        self._reported_cycle = 0
        self._reported_tick = -1
        self._next_report_s = 0.0
        self._next_pace_s = 0.0

    def serve(self, first: Restart) -> None:
        """Run until told to end."""
        self._restart(first)
        while True:
            while self._link.poll(self._patience_s()):
                command: Command | None = self._link.recv()
                if command is None:
                    return
                self._obey(command)
            if self._moving and (self._catching_up or self._pacer.waits_s() == 0.0):
                self._advance()
            self._report_pace()

    @property
    def _moving(self) -> bool:
        return self._last is not None and self._last.outcome is None and (self._catching_up or not self._paused)

    @property
    def _catching_up(self) -> bool:
        """Whether the ticks are still those that nobody wants to see."""
        return self._last is not None and self._last.tick < self._from_tick

    def _patience_s(self) -> float:
        """How long a command may be waited for."""
        if not self._moving:
            return PACE_INTERVAL_S
        return 0.0 if self._catching_up else self._pacer.waits_s()

    def _obey(self, command: Command) -> None:
        match command:
            case SetPaused(paused=paused):
                self._paused = paused
                self._pacer.reset()
                if paused and self._last is not None and self._last.tick != self._reported_tick:
                    self._report_snapshot(self._last)
            case StepOnce():
                self._paused = True
                if self._last is not None and self._last.outcome is None:
                    self._advance()
            case SetSpeed(speed=speed):
                self._pacer.speed = speed
                self._pacer.reset()
            case ApplyEvent(event=event):
                self._apply(event)
            case Restart():
                self._restart(command)
            case LookBack() | GoOn():
                pass  # the session's own business
        self._report_pace(now=True)

    def _apply(self, event: WorldEvent) -> None:
        if self._episode is None or self._last is None or self._last.outcome is not None:
            self._report(Refused("The trial is over, so its world cannot be edited: restart it first."))
            return
        if self._catching_up:
            self._report(Refused("The trial is being repeated up to the moment chosen: edit it then."))
            return
        try:
            self._episode.apply(event)
        except GraspingError as error:
            self._report(Refused(str(error)))
            return
        self._made = (*self._made, TimedEvent(tick=self._last.tick, event=event))
        self._report(Edited(self._run, (*self._made, *self._given)))

    def _restart(self, restart: Restart) -> None:
        """Close the running episode and show the first tick of the next, paused or not."""
        if self._episode is not None:
            self._episode.close()
            self._episode, self._last, self._ticks = None, None, iter(())
        try:
            self._episode = self._engine.make_episode(restart)
        except (GraspingError, OSError) as error:
            self._report(Refused(f"The trial cannot begin: {error}" if isinstance(error, OSError) else str(error)))
            return
        self._run += 1
        self._reported_cycle = 0
        self._made, self._given, self._from_tick = (), restart.events, restart.from_tick
        self._ticks = iter(self._episode.run())
        self._report(Started(self._run, restart, self._episode.scene))
        self._pacer.reset()
        self._advance(report=True)

    def _advance(self, report: bool = False) -> None:
        previous, self._last = self._last, next(self._ticks)
        now = time.perf_counter()
        if self._catching_up and self._last.outcome is None:
            self._pacer.reset()
            return
        self._pacer.ticked(now, self._last.t_s, self._last.t_s - (previous.t_s if previous else 0.0))
        report = report or self._paused or self._last.tick == self._from_tick
        if report or self._last.outcome is not None or now >= self._next_report_s:
            self._report_snapshot(self._last)
            self._next_report_s = max(self._next_report_s, now - LARGEST_BURST_S) + REPORT_INTERVAL_S
        if self._last.outcome is not None and self._episode is not None:
            self._report_end(self._episode)

    def _report_end(self, episode: Running) -> None:
        """A trial that leaves nothing, as on a full disk, has ended all the same."""
        try:
            keepsake = episode.keepsake()
        except (GraspingError, OSError) as error:
            self._report(Refused(f"The trial's trace and outcome could not be kept: {error}"))
        else:
            self._report(Ended(self._run, keepsake))

    def _report_snapshot(self, snapshot: Snapshot) -> None:
        self._reported_tick = snapshot.tick
        cycle, traces = snapshot.cycle, None
        if cycle is None or cycle.number == self._reported_cycle:
            snapshot = replace(snapshot, cycle=None)
        else:
            self._reported_cycle = cycle.number
            traces = self._traces(cycle)
            snapshot = replace(snapshot, cycle=slim(cycle))
        self._report(Progress(self._run, snapshot, traces))

    def _traces(self, cycle: CycleResult) -> Traces:
        assert self._episode is not None
        paths = (cycle.plan.path if cycle.plan else None, cycle.seed_path)
        robot = self._episode.scene.robot
        plan, seed = (None if path is None else self._engine.tcp_trace(robot, path.waypoints) for path in paths)
        return Traces(plan, seed)

    def _report_pace(self, now: bool = False) -> None:
        wall_s = time.perf_counter()
        if now or wall_s >= self._next_pace_s:
            self._next_pace_s = wall_s + PACE_INTERVAL_S
            factor = self._pacer.real_time_factor() if self._moving else 0.0
            self._report(Pace(self._paused, self._pacer.speed, factor))

    def _report(self, report: Report) -> None:
        self._link.send(report)
