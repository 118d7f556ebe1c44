"""Laws of looking back at the last minute of a trial, and of going on from there."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import pytest

from app.commands import ApplyEvent, GoOn, LookBack, SetPaused, SetSpeed, StepOnce
from app.history import KEPT_S, History, Moment
from app.session import Session
from app.state import SessionState
from app.ui.panels.belt import rate_asked_for
from app.ui.strip import cycle_times, span_s, stretches, strip_svg
from backend.errors import InvalidInputError
from backend.events import SetBeltRate
from tests.app.fake_episode import LINEAR, FakeEngine
from tests.app.sessions import tick, wait


def shown_tick(state: SessionState) -> int:
    return tick(state.shown)


def play_to(session: Session, last: int) -> SessionState:
    session.send(SetSpeed(speed=8.0))
    session.send(SetPaused(paused=False))
    wait(session, lambda s: tick(s) >= last)
    session.send(SetPaused(paused=True))
    return wait(session, lambda s: s.pace.paused and s.pace.real_time_factor == 0.0)


def all_moments(seed: int = 0) -> list[Moment]:
    return [Moment(s, None) for s in FakeEngine().make_episode(LINEAR.model_copy(update={"seed": seed})).run()]


def test_looking_back_pauses_and_shows_what_was(session: Session) -> None:
    session.send(SetPaused(paused=False))
    wait(session, lambda s: tick(s) > 20)
    session.send(LookBack(t_s=0.3))
    state = wait(session, lambda s: s.pace.paused)
    assert shown_tick(state) <= 12 < tick(state)
    assert state.snapshot is not None and state.shown.snapshot is not None
    assert state.shown.snapshot.T_world_object.xyz_m[1] < state.snapshot.T_world_object.xyz_m[1]
    session.send(LookBack(t_s=None))
    assert session.state.looked_at is None


def test_whoever_steps_or_plays_is_back_at_the_newest(session: Session) -> None:
    newest = tick(play_to(session, 30))
    session.send(LookBack(t_s=0.2))
    session.send(StepOnce())
    state = wait(session, lambda s: tick(s) > newest)
    assert shown_tick(state) == tick(state)
    session.send(LookBack(t_s=99.0))
    assert session.state.looked_at is None, "the end of the past is now"


def test_a_belt_edited_while_paused_shows_what_was_asked_for_and_before_it_what_was(session: Session) -> None:
    at_edit = play_to(session, 30).snapshot
    assert at_edit is not None
    session.send(ApplyEvent(event=SetBeltRate(rate=-2.0)))
    state = wait(session, lambda s: bool(s.events))
    assert state.snapshot is not None and state.snapshot.belt_rate == 1.0, "no time has gone by"
    assert rate_asked_for(state) == -2.0
    session.send(StepOnce())
    session.send(LookBack(t_s=at_edit.t_s - 0.2))
    assert rate_asked_for(wait(session, lambda s: s.looked_at is not None).shown) == 1.0


def test_the_past_cannot_be_edited(session: Session) -> None:
    play_to(session, 30)
    session.send(LookBack(t_s=0.2))
    with pytest.raises(InvalidInputError, match="past cannot be edited"):
        session.send(ApplyEvent(event=SetBeltRate(rate=2.0)))


def test_going_on_from_a_moment_leads_there_again_with_the_edits_of_before_only(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(StepOnce())
    wait(session, lambda s: tick(s) == 1)
    session.send(ApplyEvent(event=SetBeltRate(rate=2.0)))
    play_to(session, 60)
    session.send(ApplyEvent(event=SetBeltRate(rate=-1.0)))
    play_to(session, 90)
    session.send(SetSpeed(speed=1 / 8))
    session.send(LookBack(t_s=1.0))
    then = session.state.shown.snapshot
    assert then is not None
    session.send(GoOn())
    state = wait(session, lambda s: s.started is not None and s.started.run == 2 and tick(s) > then.tick)
    assert not state.pace.paused and state.looked_at is None
    assert [timed.event for timed in state.events] == [SetBeltRate(rate=2.0)]
    assert state.snapshot is not None and state.snapshot.belt_rate == 2.0
    again = session.history.at(then.t_s)
    assert again is not None and again.snapshot.tick == then.tick
    assert (again.snapshot.T_world_object.xyz_m == then.T_world_object.xyz_m).all()
    ticks = [moment.snapshot.tick for moment in session.history.moments()]
    assert ticks[0] == 0 and ticks == sorted(set(ticks)), "what was before is kept, without a gap or a double"


def test_there_must_be_a_moment_to_go_on_from(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    with pytest.raises(InvalidInputError, match="earlier moment first"):
        session.send(GoOn())


def test_a_trial_with_measured_thinking_is_not_gone_on_with() -> None:
    first = LINEAR.model_copy(update={"overrides": {"timing.think": "measured"}})
    session = Session(FakeEngine(), first, paused=True)
    session.start()
    try:
        play_to(session, 10)
        session.send(LookBack(t_s=0.1))
        with pytest.raises(InvalidInputError, match="twice the same"):
            session.send(GoOn())
    finally:
        session.close()


def test_a_restart_forgets_the_past(session: Session) -> None:
    play_to(session, 30)
    session.send(LookBack(t_s=0.2))
    session.send(LINEAR.model_copy(update={"seed": 2}))
    state = wait(session, lambda s: s.started is not None and s.started.run == 2 and tick(s) == 0)
    assert state.looked_at is None
    assert [moment.snapshot.tick for moment in session.history.moments()] == [0]


def test_a_minute_is_kept_and_the_nearest_moment_found() -> None:
    history, (first, *_) = History(), all_moments()
    assert history.at(1.0) is None
    for k in range(2000):
        history.add(Moment(replace(first.snapshot, tick=k, t_s=0.1 * k), None))
    kept = history.moments()
    assert kept[-1].snapshot.t_s - kept[0].snapshot.t_s == pytest.approx(KEPT_S, abs=0.11)
    for t_s, expected in ((0.0, kept[0]), (1e9, kept[-1]), (kept[7].snapshot.t_s + 0.04, kept[7])):
        assert history.at(t_s) is expected
    history.cut(kept[10].snapshot.tick)
    assert history.moments() == kept[:11]


def test_the_strip_has_every_phase_in_order_and_a_mark_for_every_cycle() -> None:
    moments = all_moments()
    parts = stretches(moments)
    assert [part.phase for part in parts] == ["watch", "move", "approach", "close", "lift", "hold", "done"]
    assert all(a.end_s == b.begin_s for a, b in itertools.pairwise(parts))
    planned, refused = cycle_times(moments)
    assert (len(planned), refused) == (100, [])
    assert span_s(moments) == (0.0, pytest.approx(20.0)) and span_s(moments[:3]) == (0.0, 15.0)
    html = strip_svg(moments, 10.0)
    assert len(re.findall(r"M[\d.]+ 18v7", html)) == 100 and 'd="M500.0 0v' in html
    no_plan = replace(moments[9].snapshot.cycle, refused_by="plan")  # pyright: ignore[reportArgumentType]
    assert cycle_times([replace(moments[9], snapshot=replace(moments[9].snapshot, cycle=no_plan))])[1] != []
