"""Laws of the simulation process and of the server's side of it."""

import os
import signal
import time

import pytest

from app.commands import ApplyEvent, Restart, SetPaused, SetSpeed, StepOnce
from app.session import Session
from app.state import SimulationDownError
from backend.errors import InvalidInputError, NotFoundError
from backend.events import MoveObstacle, SetBeltRate
from tests.app.fake_episode import LINEAR, FakeEngine
from tests.app.sessions import tick, wait


def test_a_paused_session_shows_the_start_and_steps_one_tick_at_a_time(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(StepOnce())
    session.send(StepOnce())
    wait(session, lambda s: tick(s) == 2)
    time.sleep(0.2)
    assert tick(session.state) == 2


def test_a_step_pauses_what_is_playing(session: Session) -> None:
    session.send(SetPaused(paused=False))
    wait(session, lambda s: tick(s) > 3)
    session.send(StepOnce())
    state = wait(session, lambda s: s.pace.paused)
    time.sleep(0.2)
    assert tick(session.state) <= tick(state) + 1


def test_the_pace_is_kept_at_every_speed(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    for speed, patience in ((0.5, 1.2), (4.0, 1.2)):
        session.send(SetSpeed(speed=speed))
        session.send(SetPaused(paused=False))
        time.sleep(patience)
        assert session.state.pace.real_time_factor == pytest.approx(speed, rel=0.25)


def test_as_fast_as_it_goes_ends_the_trial_and_reports_its_outcome(session: Session) -> None:
    session.send(SetSpeed(speed=None))
    session.send(SetPaused(paused=False))
    state = wait(session, lambda s: s.snapshot is not None and s.snapshot.outcome is not None)
    assert tick(state) == 600
    assert state.snapshot is not None and state.snapshot.outcome is not None and state.snapshot.outcome.strict


def test_the_newest_cycle_is_never_lost(session: Session) -> None:
    session.send(SetSpeed(speed=8.0))
    session.send(SetPaused(paused=False))
    state = wait(session, lambda s: tick(s) > 100)
    assert state.snapshot is not None and state.snapshot.cycle is not None
    assert state.snapshot.cycle.number == state.snapshot.cycles
    assert state.traces is not None and state.traces.plan_m is not None


def test_a_live_edit_acts_on_the_running_trial(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(ApplyEvent(event=SetBeltRate(rate=-2.0)))
    session.send(StepOnce())
    state = wait(session, lambda s: tick(s) == 1)
    assert state.snapshot is not None and state.snapshot.belt_rate == -2.0
    assert state.started is not None and state.started.run == 1


def test_an_edit_the_world_refuses_is_said_and_stops_nothing(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(ApplyEvent(event=MoveObstacle(index=9, x_m=0.0, y_m=0.0)))
    state = wait(session, lambda s: s.refusals[0] == 1)
    assert "there is no obstacle" in state.refusals[1]
    assert state.status == "running"


def test_a_restart_begins_anew_with_its_seed_and_keeps_the_pause(session: Session) -> None:
    session.send(StepOnce())
    wait(session, lambda s: tick(s) == 1)
    session.send(Restart(scenario="ur5_linear_slab", seed=4, overrides={"object": "cube"}))
    state = wait(session, lambda s: s.started is not None and s.started.run == 2 and tick(s) == 0)
    assert state.started is not None and state.started.scene.seed == 4
    assert state.info.object == "cube"
    assert state.pace.paused and not state.loading


@pytest.mark.parametrize(
    ("restart", "error", "text"),
    [
        (
            Restart(scenario="nowhere", overrides={}),
            NotFoundError,
            "Available: boom, mico_varying, ur5_linear",
        ),
        (
            Restart(scenario="ur5_linear", overrides={"task.speed_mps": 7.0}),
            InvalidInputError,
            "less than or equal to 0.5",
        ),
    ],
)
def test_a_restart_that_cannot_run_changes_nothing(
    session: Session, restart: Restart, error: type[Exception], text: str
) -> None:
    wait(session, lambda s: tick(s) == 0)
    with pytest.raises(error, match=text):
        session.send(restart)
    assert session.state.restart == LINEAR and not session.state.loading


def test_an_exception_in_the_simulation_is_shown_with_its_traceback_and_restart_recovers(
    session: Session,
) -> None:
    session.send(Restart(scenario="boom", overrides={}))
    session.send(SetPaused(paused=False))
    state = wait(session, lambda s: s.status == "crashed")
    assert state.crash is not None
    assert state.crash.cause == "ZeroDivisionError: the fake world has come apart"
    assert "fake_episode.py" in state.crash.traceback
    with pytest.raises(SimulationDownError, match="restart it first"):
        session.send(StepOnce())
    session.send(LINEAR)
    wait(session, lambda s: s.status == "running" and tick(s) >= 0)


def test_a_killed_simulation_is_told_from_one_that_ended_by_itself(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    assert session.process_id is not None
    os.kill(session.process_id, signal.SIGKILL)
    state = wait(session, lambda s: s.status == "crashed")
    assert state.crash is not None and "SIGKILL" in state.crash.cause
    session.send(Restart(scenario="boom", seed=99, overrides={}))
    state = wait(session, lambda s: s.status == "crashed" and s.restart.seed == 99)
    assert state.crash is not None and "exit code 7" in state.crash.cause


def test_closing_ends_the_process_without_calling_it_a_crash() -> None:
    session = Session(FakeEngine(), LINEAR)
    session.start()
    wait(session, lambda s: tick(s) > 0)
    process_id = session.process_id
    session.close()
    assert session.state.crash is None
    assert process_id is not None
    with pytest.raises(ProcessLookupError):
        os.kill(process_id, 0)
