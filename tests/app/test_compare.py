"""Laws of comparing: two methods at the same trial, in step, and each as it would be alone."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest
import viser

from app.backend_engine import BackendEngine
from app.commands import ApplyEvent, GoOn, LookBack, OverrideValue, Restart, SetPaused, SetSpeed, StepOnce
from app.history import Moment
from app.permalink import address_of, trial_at
from app.reports import Pace, Sight, Started
from app.session import Session
from app.state import SessionState
from app.ui.camera import beside_m
from app.ui.contenders import NOTHING, contenders
from app.ui.desk import Desk
from app.ui.palette import BAD, css
from app.ui.panels import View
from app.ui.panels.method import MethodPanel
from app.ui.panels.trial import TrialPanel
from app.ui.progress import AutoNext, Tally
from app.ui.robot_parts import load_robot_parts
from app.ui.strip import strip_svg
from app.ui.touch import Untouched
from app.ui.worlds import Worlds
from app.wanted import compared_with, scenario_of
from backend.errors import NotFoundError
from backend.events import MoveObstacle, SetBeltRate, TimedEvent
from backend.methods import METHODS
from backend.pose import Pose
from tests.app.fake_episode import LINEAR, FakeEngine
from tests.app.sessions import tick, wait

PAIR = LINEAR.model_copy(update={"compare": "baseline"})
ENGINE = FakeEngine()
LINK_M = 0.15
"""About as far as a link's shape reaches beyond its frame and the next one's."""


@pytest.fixture
def pair(session: Session) -> Session:
    wait(session, lambda s: tick(s) == 0)
    session.send(PAIR)
    wait(session, lambda s: s.beside is not None and not s.loading)
    return session


def ticks(state: SessionState) -> tuple[int, int]:
    return tick(state), -1 if state.beside is None else state.beside.snapshot.tick


def play_to_the_end(session: Session) -> SessionState:
    session.send(SetSpeed(speed=None))
    session.send(SetPaused(paused=False))
    return wait(session, lambda s: s.over and s.keepsake is not None and s.keepsake_beside is not None)


def test_both_step_together_and_what_was_reported_holds_both(pair: Session) -> None:
    for expected in (1, 2, 3):
        pair.send(StepOnce())
        state = wait(pair, lambda s, k=expected: tick(s) == k)
        assert ticks(state) == (expected, expected)
    assert [(m.snapshot.tick, m.beside.snapshot.tick if m.beside else None) for m in pair.history.moments()] == [
        (k, k) for k in range(4)
    ]


def test_the_one_that_ends_first_holds_its_last_state_until_both_are_over(pair: Session) -> None:
    pair.send(SetSpeed(speed=8.0))
    pair.send(SetPaused(paused=False))
    state = wait(pair, lambda s: tick(s) > 310)
    assert ticks(state)[1] == 300 and not state.over
    assert state.beside is not None and state.beside.snapshot.outcome is not None
    assert state.keepsake is None and state.keepsake_beside is not None
    state = play_to_the_end(pair)
    assert ticks(state) == (600, 300)
    assert [contender.words for contender in contenders(state)] == [
        "ours_rm: lifted after 17.5 s",
        "baseline: belt end",
    ]


def test_the_shorter_of_two_may_be_the_first_one(session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    session.send(LINEAR.model_copy(update={"overrides": {"method": "baseline"}, "compare": "ours_rm"}))
    wait(session, lambda s: s.beside is not None and not s.loading)
    state = play_to_the_end(session)
    assert ticks(state) == (300, 600) and state.newest is not None and state.newest.tick == 600
    moments = session.history.moments()
    times = [moment.t_s for moment in moments]
    assert times == sorted(times) and times[-1] == pytest.approx(20.0)
    assert moments[-1].snapshot is moments[-2].snapshot, "what has ended is kept once"
    then = next(moment for moment in moments if 300 < moment.tick < 600)
    session.send(LookBack(t_s=then.t_s))
    shown = session.state.shown
    assert shown.snapshot is not None and shown.snapshot.outcome is not None
    assert shown.beside is not None and shown.beside.snapshot is then.newest


def test_a_live_edit_goes_to_both_and_is_recorded_once(pair: Session) -> None:
    pair.send(ApplyEvent(event=SetBeltRate(rate=-2.0)))
    pair.send(StepOnce())
    state = wait(pair, lambda s: tick(s) == 1)
    assert state.snapshot is not None and state.beside is not None
    assert state.snapshot.belt_rate == state.beside.snapshot.belt_rate == -2.0
    assert [(timed.tick, timed.event) for timed in state.events] == [(0, SetBeltRate(rate=-2.0))]
    pair.send(ApplyEvent(event=MoveObstacle(index=9, x_m=0.0, y_m=0.0)))
    assert "no obstacle" in wait(pair, lambda s: s.refusals[0] == 1).refusals[1]


def test_an_edit_after_one_end_reaches_the_other_only(pair: Session) -> None:
    pair.send(SetSpeed(speed=8.0))
    pair.send(SetPaused(paused=False))
    wait(pair, lambda s: tick(s) > 310)
    pair.send(ApplyEvent(event=SetBeltRate(rate=3.0)))
    state = wait(pair, lambda s: s.snapshot is not None and s.snapshot.belt_rate == 3.0)
    assert state.beside is not None and state.beside.snapshot.belt_rate == 1.0
    assert state.events[0].tick > 310 and state.refusals[0] == 0


def test_going_on_from_a_moment_takes_both_there(pair: Session) -> None:
    pair.send(SetSpeed(speed=8.0))
    pair.send(SetPaused(paused=False))
    wait(pair, lambda s: tick(s) > 90)
    pair.send(LookBack(t_s=1.0))
    then = wait(pair, lambda s: s.looked_at is not None).looked_at
    assert then is not None
    pair.send(SetSpeed(speed=1 / 8))
    pair.send(GoOn())
    state = wait(pair, lambda s: s.started is not None and s.started.run == 3 and tick(s) > then.tick)
    assert ticks(state)[0] == ticks(state)[1]
    known = [moment.tick for moment in pair.history.moments()]
    assert known[0] == 0 and known == sorted(set(known))


def test_a_new_seed_keeps_the_comparison_and_nothing_ends_it(pair: Session, server: viser.ViserServer) -> None:
    desk = Desk(server, pair)
    desk.restart(seed=5)
    state = wait(pair, lambda s: s.restart.seed == 5 and s.beside is not None and not s.loading)
    assert state.restart.compare == "baseline"
    desk.restart(scenario="ur5_linear_slab")
    wait(pair, lambda s: s.info.scenario == "ur5_linear_slab" and s.beside is not None and not s.loading)
    desk.compare(None)
    state = wait(pair, lambda s: s.restart.compare is None and tick(s) == 0 and not s.loading)
    assert state.beside is None and state.info.scenario == "ur5_linear_slab"


def test_a_method_that_is_not_there_is_refused_and_changes_nothing(pair: Session) -> None:
    for name in ("best", "none", "{}"):
        with pytest.raises(NotFoundError, match=f"There is no method named '{name}'. Available: baseline, ik"):
            pair.send(LINEAR.model_copy(update={"compare": name}))
    assert pair.state.restart == PAIR and not pair.state.loading


@pytest.mark.parametrize("method", METHODS)
def test_only_the_method_differs_and_it_is_as_listed(method: str) -> None:
    overrides: dict[str, OverrideValue] = {
        "object": "cube",
        "method.planner.kind": "chomp",
        "timing.think": "paper",
        "method": "no_seeding",
    }
    asked = Restart(scenario="ur5_linear", seed=3, overrides=overrides, compare=method)
    other = compared_with(asked)
    assert other is not None and other.compare is None and (other.seed, other.events) == (asked.seed, asked.events)
    mine, theirs = scenario_of(asked), scenario_of(other)
    assert theirs.method == METHODS[method]
    assert theirs.model_copy(update={"method": mine.method}) == mine
    assert compared_with(LINEAR) is None


def test_a_link_carries_it() -> None:
    assert "&compare=baseline" in address_of(PAIR) and "compare" not in address_of(LINEAR)
    assert trial_at(dict(httpx.URL("http://x" + address_of(PAIR)).params)) == PAIR


def moments_of_both() -> list[Moment]:
    one, other = (list(ENGINE.make_episode(trial).run()) for trial in (LINEAR, compared_with(PAIR) or PAIR))
    beside = [other[min(k, len(other) - 1)] for k in range(len(one))]
    return [Moment(a, None, Sight(b, None)) for a, b in zip(one, beside, strict=True)]


MOMENTS = moments_of_both()


def state_at(k: int) -> SessionState:
    scene = ENGINE.make_episode(PAIR).scene
    pace, moment = Pace(paused=False, speed=1.0, real_time_factor=1.0), MOMENTS[k]
    return SessionState(
        "running",
        ENGINE.describe(PAIR),
        PAIR,
        loading=False,
        pace=pace,
        started=Started(1, PAIR, scene),
        snapshot=moment.snapshot,
        beside=moment.beside,
    )


def test_two_worlds_stand_side_by_side_each_under_its_caption(server: viser.ViserServer) -> None:
    worlds, state = Worlds(server.scene, Untouched()), state_at(400)
    assert state.started is not None and state.snapshot is not None and state.beside is not None
    shift_m = beside_m(state.started)
    assert shift_m is not None
    worlds.begin(state.started, state.view)
    worlds.draw(state)

    def node(name: str) -> Any:
        handle = server.scene.get_handle_by_name(name)
        assert handle is not None, name
        return handle

    np.testing.assert_allclose(node("/beside").position, shift_m)
    for under, snapshot in (("", state.snapshot), ("/beside", state.beside.snapshot)):
        np.testing.assert_allclose(node(under + "/object/body").position, snapshot.T_world_object.xyz_m)
    assert [node(f"/{where}/caption").text for where in ("here", "beside")] == [
        "ours_rm: closing hand",
        "baseline: belt end",
    ]
    hidden = state.view.with_layer("Object", shown=False)
    worlds.draw(replace(state, view=hidden))
    assert not node("/object").visible and not node("/beside/object").visible
    worlds.begin(replace(state.started, restart=LINEAR), hidden)
    assert server.scene.get_handle_by_name("/beside") is None
    assert server.scene.get_handle_by_name("/beside/robot") is None
    assert server.scene.get_handle_by_name("/here/caption") is None
    worlds.begin(state.started, hidden)
    assert not node("/beside/object").visible, "what was hidden stays hidden"
    worlds.begin(replace(state.started, restart=LINEAR), hidden)


@pytest.mark.parametrize("name", ("ur5_linear", "ur5_sinusoidal", "mico_circular", "mico_linear_obstacles"))
def test_the_worlds_do_not_reach_into_each_other(name: str) -> None:
    """Judged by where the links and the object of real trials are, in the direction in which the worlds are apart."""
    restart = Restart(scenario=name, seed=1, overrides={"timing.timeout_s": 12.0}, compare="baseline")
    episode = BackendEngine().make_episode(restart)
    shift_m = beside_m(Started(1, restart, episode.scene))
    assert shift_m is not None
    apart_m = float(np.linalg.norm(shift_m))
    tree, low, high = load_robot_parts(episode.scene.robot).tree, np.inf, -np.inf
    for snapshot in itertools.islice(episode.run(), 0, None, 10):
        links = [T.xyz_m if isinstance(T, Pose) else T[:3, 3] for T in tree.link_poses(snapshot.joints_rad).values()]
        points = [*links, snapshot.T_world_object.xyz_m, *snapshot.Ts_world_obstacle[:, :3, 3]]
        along = np.array(points) @ shift_m / apart_m
        low, high = min(low, along.min()), max(high, along.max())
    episode.close()
    assert high - low + LINK_M < apart_m


def test_the_page_says_how_either_ended(server: viser.ViserServer) -> None:
    session = Session(ENGINE, PAIR)
    panel = TrialPanel(server.gui, Desk(server, session))
    view = View(state_at(400), state_at(400), tuple(MOMENTS), Tally(ended=4, grasped=3, grasped_beside=1), None, "")
    panel.show(view)
    banner, facts = (getattr(panel, name).content for name in ("_banner", "_facts"))
    assert "Closing hand." in banner and "Belt end." in banner and css(BAD) in banner
    assert "3 / 1 of 4" in facts
    strip = strip_svg(MOMENTS, 10.0, contenders(view.state))
    assert strip.count("<svg") == 2 and len(re.findall('d="M500.0 0v', strip)) == 2
    assert strip.index("ours_rm: closing hand") < strip.index("baseline: belt end")


def test_trials_are_counted_when_both_are_over_and_the_next_waits_for_that() -> None:
    tally, auto_next = Tally(), AutoNext()
    states = [state_at(k) for k in (100, 400, 600)]
    for state in (*states, states[-1]):
        tally = tally.after(state)
        assert (auto_next.remaining_s(state, 10.0) is not None) is (state is states[-1])
    assert (tally.ended, tally.grasped, tally.grasped_beside) == (1, 1, 0)


def test_the_choice_restarts_with_a_second_world_or_without(pair: Session, server: viser.ViserServer) -> None:
    panel = MethodPanel(server.gui, Desk(server, pair))
    assert panel.set_compare("ours_rm") == "Restarted with ours_rm beside it."
    assert pair.state.restart.compare == "ours_rm"
    assert panel.set_compare(NOTHING) == "Restarted without comparison."
    assert pair.state.restart == LINEAR
    edited = LINEAR.model_copy(update={"events": (TimedEvent(tick=3, event=SetBeltRate(rate=2.0)),), "from_tick": 2})
    pair.send(edited)
    panel.set_compare("baseline")
    assert pair.state.restart == edited.model_copy(update={"compare": "baseline", "from_tick": 0})
    with pytest.raises(NotFoundError):
        panel.set_compare("best")
