"""The simulation process: drains commands, advances the episode at wall pace, reports the newest snapshot."""

from __future__ import annotations

import signal
import sys
import time
import traceback
from multiprocessing.connection import Connection

from app.commands import ApplyEvent, Command, GoOn, LookBack, Restart, SetPaused, SetSpeed, StepOnce
from app.engine import Engine
from app.lane import Lane
from app.pacer import Pacer
from app.reports import Crashed, Edited, Ended, Pace, Progress, Refused, Report, Started
from app.wanted import compared_with
from backend.errors import GraspingError
from backend.events import TimedEvent, WorldEvent
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
    """Owns the one episode of its process, or the two that are compared."""

    def __init__(self, link: Connection, engine: Engine, pace: Pace) -> None:
        self._link = link
        self._engine = engine
        self._paused = pace.paused
        self._pacer = Pacer(pace.speed)
        self._run = 0
        self._lanes: tuple[Lane, ...] = ()
        self._told: tuple[Lane, ...] = ()
        """Those whose end has been reported."""
        self._made: tuple[TimedEvent, ...] = ()
        self._given: tuple[TimedEvent, ...] = ()
        self._from_tick = 0
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
    def _running(self) -> tuple[Lane, ...]:
        """Lanes that are not over."""
        return tuple(lane for lane in self._lanes if not lane.over)

    @property
    def _newest(self) -> Snapshot:
        """Of the lane that has come furthest."""
        return max((lane.last for lane in self._lanes), key=lambda snapshot: snapshot.tick)

    @property
    def _moving(self) -> bool:
        return bool(self._running) and (self._catching_up or not self._paused)

    @property
    def _catching_up(self) -> bool:
        """Whether the ticks are still those that nobody wants to see."""
        return bool(self._running) and self._newest.tick < self._from_tick

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
                if paused and self._lanes and self._newest.tick != self._reported_tick:
                    self._report_progress()
            case StepOnce():
                self._paused = True
                if self._running:
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
        """To every world that still moves, or, where one of them refuses it, to none."""
        if not self._running:
            self._report(Refused("The trial is over, so its world cannot be edited: restart it first."))
            return
        if self._catching_up:
            self._report(Refused("The trial is being repeated up to the moment chosen: edit it then."))
            return
        try:
            for lane in self._running:
                lane.episode.check(event)
            for lane in self._running:
                lane.apply(event)
        except GraspingError as error:
            self._report(Refused(str(error)))
            return
        self._made = (*self._made, TimedEvent(tick=self._newest.tick, event=event))
        self._report(Edited(self._run, (*self._made, *self._given)))
        if self._paused:
            self._report_progress()

    def _restart(self, restart: Restart) -> None:
        """Close what is running and show the first tick of what comes next, paused or not."""
        self._close()
        try:
            compared = compared_with(restart)
            for one in (restart,) if compared is None else (restart, compared):
                self._lanes = (*self._lanes, Lane(self._engine.make_episode(one), self._engine))
        except (GraspingError, OSError) as error:
            self._close()
            self._report(Refused(f"The trial cannot begin: {error}" if isinstance(error, OSError) else str(error)))
            return
        self._run += 1
        self._made, self._given, self._from_tick = (), restart.events, restart.from_tick
        scene = self._lanes[0].episode.scene
        self._report(Started(self._run, restart, scene, self._engine.reach(scene.robot)))
        self._pacer.reset()
        if not self._catching_up:
            self._report_progress()

    def _close(self) -> None:
        for lane in self._lanes:
            lane.episode.close()
        self._lanes = self._told = ()

    def _advance(self) -> None:
        before_s = self._newest.t_s
        for lane in self._running:
            lane.advance()
        now, newest = time.perf_counter(), self._newest
        if self._catching_up:
            self._pacer.reset()
            return
        self._pacer.ticked(now, newest.t_s, newest.t_s - before_s)
        ended = any(lane.over and lane not in self._told for lane in self._lanes)
        if ended or self._paused or newest.tick == self._from_tick or now >= self._next_report_s:
            self._report_progress()
            self._next_report_s = max(self._next_report_s, now - LARGEST_BURST_S) + REPORT_INTERVAL_S

    def _report_end(self, lane: Lane) -> None:
        """A trial that leaves nothing, as on a full disk, has ended all the same."""
        try:
            keepsake = lane.episode.keepsake()
        except (GraspingError, OSError) as error:
            self._report(Refused(f"The trial's trace and outcome could not be kept: {error}"))
        else:
            self._report(Ended(self._run, keepsake, beside=lane is not self._lanes[0]))

    def _report_progress(self) -> None:
        """One tick of all lanes, and which of them are over by now."""
        self._reported_tick = self._newest.tick
        first, *others = (lane.news() for lane in self._lanes)
        self._report(Progress(self._run, first.snapshot, first.traces, others[0] if others else None))
        for lane in self._lanes:
            if lane.over and lane not in self._told:
                self._told = (*self._told, lane)
                self._report_end(lane)

    def _report_pace(self, now: bool = False) -> None:
        wall_s = time.perf_counter()
        if now or wall_s >= self._next_pace_s:
            self._next_pace_s = wall_s + PACE_INTERVAL_S
            factor = self._pacer.real_time_factor() if self._moving else 0.0
            self._report(Pace(self._paused, self._pacer.speed, factor))

    def _report(self, report: Report) -> None:
        self._link.send(report)
