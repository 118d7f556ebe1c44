"""One loop, two drivers: a trial run by the page's worker is the headless trial, bit for bit."""

import multiprocessing
import time
from collections.abc import Generator
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import pytest

from app.backend_engine import BackendEngine
from app.commands import ApplyEvent, Command, Restart, SetPaused, StepOnce
from app.reports import Pace, Progress, Started
from app.worker import run_worker
from backend.events import SetBeltRate, TimedEvent
from backend.experiments.trial import run_trial
from backend.scenario import Scenario, load_scenario, scenario_names, with_overrides
from backend.snapshot import Snapshot

pytestmark = pytest.mark.xdist_group("parity")

SHORT: dict[str, bool | int | float | str] = {"timing.timeout_s": 3.0, "object": "cube"}
STEP = StepOnce()


def headless(name: str) -> Scenario:
    return with_overrides(load_scenario(name), [f"{path}={value}" for path, value in SHORT.items()])


def is_over(report: Progress) -> bool:
    worlds = [report.snapshot, *([report.beside.snapshot] if report.beside else [])]
    return all(snapshot.outcome is not None for snapshot in worlds)


@dataclass(frozen=True)
class Live:
    """The page's own simulation process, as fast as it goes."""

    link: Connection

    def trial(self, name: str, seed: int, *commands: Command, **how: Any) -> Snapshot:
        """The last snapshot of a trial that begins paused, obeys some commands, and then runs to its end."""
        return self.ends(Restart(scenario=name, seed=seed, overrides=SHORT, **how), *commands).snapshot

    def ends(self, restart: Restart, *commands: Command) -> Progress:
        """The same, of two that are compared."""
        for command in (SetPaused(paused=True), restart, *commands, SetPaused(paused=False)):
            self.link.send(command)
        run = None
        deadline = time.monotonic() + 120.0
        while time.monotonic() < deadline:
            report = self.link.recv() if self.link.poll(1.0) else None
            if isinstance(report, Started) and report.restart == restart:
                run = report.run
            if isinstance(report, Progress) and report.run == run and is_over(report):
                return report
        raise AssertionError("the live trial did not end")


@pytest.fixture(scope="module")
def live() -> Generator[Live]:
    spawn = multiprocessing.get_context("spawn")
    ours, theirs = spawn.Pipe()
    first = Restart(scenario="ur5_linear", seed=0, overrides=SHORT)
    pace = Pace(paused=True, speed=None, real_time_factor=0.0)
    process = spawn.Process(target=run_worker, args=(theirs, BackendEngine(), first, pace))
    process.start()
    yield Live(ours)
    ours.send(None)
    process.join(timeout=30.0)
    assert process.exitcode == 0


@pytest.mark.parametrize("name", scenario_names())
def test_live_equals_headless(live: Live, name: str):
    assert live.trial(name, 7).fingerprint == run_trial(headless(name), seed=7).fingerprint


def test_pausing_and_stepping_change_nothing(live: Live):
    stepped = live.trial("ur5_linear", 7, *[STEP] * 20)
    assert stepped.fingerprint == run_trial(headless("ur5_linear"), seed=7).fingerprint


def test_a_live_edit_is_the_same_as_a_scheduled_one(live: Live):
    edit = SetBeltRate(rate=0.5)
    edited = live.trial("mico_linear", 7, *[STEP] * 10, ApplyEvent(event=edit))
    scheduled = headless("mico_linear").model_copy(update={"events": (TimedEvent(tick=10, event=edit),)})
    assert edited.fingerprint == run_trial(scheduled, seed=7).fingerprint
    assert edited.fingerprint != run_trial(headless("mico_linear"), seed=7).fingerprint


def test_a_trial_gone_on_with_is_the_trial_it_was(live: Live):
    edits = (TimedEvent(tick=10, event=SetBeltRate(rate=0.5)),)
    from_start = live.trial("ur5_linear", 7, events=edits)
    gone_on_with = live.trial("ur5_linear", 7, events=edits, from_tick=40)
    scheduled = headless("ur5_linear").model_copy(update={"events": edits})
    assert gone_on_with.fingerprint == from_start.fingerprint == run_trial(scheduled, seed=7).fingerprint


@pytest.mark.parametrize(
    ("name", "method", "other"),
    [("ur5_linear", "ours_rm", "no_prediction"), ("mico_linear_obstacles", "ours_rm", "motion_aware")],
)
def test_either_of_two_that_are_compared_is_what_it_is_alone(live: Live, name: str, method: str, other: str):
    """In one process and step by step with the other, edited alike, and whichever ends first."""
    edit = SetBeltRate(rate=0.5)
    wanted = {**SHORT, "timing.timeout_s": 20.0, "method": method}
    restart = Restart(scenario=name, seed=4, overrides=wanted, compare=other)
    both = live.ends(restart, *[STEP] * 10, ApplyEvent(event=edit))
    assert both.beside is not None
    for snapshot, by in ((both.snapshot, method), (both.beside.snapshot, other)):
        scenario = with_overrides(load_scenario(name), [f"{path}={v}" for path, v in {**wanted, "method": by}.items()])
        alone = scenario.model_copy(update={"events": (TimedEvent(tick=10, event=edit),)})
        assert snapshot.fingerprint == run_trial(alone, seed=4).fingerprint
    assert both.snapshot.fingerprint != both.beside.snapshot.fingerprint
