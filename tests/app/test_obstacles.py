"""Laws of obstacles and slab edited from the page."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import viser

from app.commands import ApplyEvent, LookBack, StepOnce
from app.live_episode import LiveEpisode
from app.session import Session
from app.state import SessionState
from app.ui.desk import Desk
from app.ui.layers.bodies import ObstaclesLayer
from app.ui.layers.layer import Picture
from app.ui.panels.obstacles import ObstaclesPanel
from app.ui.panels.panel import View
from app.ui.placing import FROM_OTHERS_M, free_place
from app.ui.progress import Tally
from app.ui.touch import Untouched
from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.events import AddObstacle, MoveObstacle, RemoveObstacle, SetSlab, TimedEvent
from backend.scenario import load_scenario, scenario_names
from backend.snapshot import Snapshot
from tests.app.sessions import tick, wait


def shown(panel: ObstaclesPanel, state: SessionState) -> tuple[tuple[str, ...], bool]:
    """What the panel says is standing, and whether it says there is a slab."""
    panel.show(View(state.shown, state, (), Tally(), None, ""))
    parts: Any = panel
    return tuple(parts._which.options), parts._slab.value


def around(state: SessionState) -> Snapshot:
    assert state.snapshot is not None
    return state.snapshot


def test_what_is_put_up_and_taken_away_while_paused_is_seen_at_once_and_recorded(
    server: viser.ViserServer, session: Session
) -> None:
    wait(session, lambda s: tick(s) == 0)
    panel = ObstaclesPanel(server.gui, Desk(server, session))
    three = ("1 tomato_soup_can", "2 cube", "3 sugar_box")
    assert shown(panel, session.state) == (three, False)
    assert "power_drill put up at" in (panel.add("power_drill") or "")
    state = wait(session, lambda s: len(around(s).obstacles) == 4)
    assert tick(state) == 0 and shown(panel, state)[0] == (*three, "4 power_drill")
    assert panel.remove("2 cube") == "2 cube taken away in the running trial."
    panel.set_slab(True)
    state = wait(session, lambda s: around(s).slab is not None)
    assert shown(panel, state) == (("1 tomato_soup_can", "2 sugar_box", "3 power_drill"), True)
    kinds = [type(timed.event) for timed in wait(session, lambda s: len(s.events) == 3).events]
    assert kinds == [AddObstacle, RemoveObstacle, SetSlab]
    panel.set_slab(False)
    wait(session, lambda s: around(s).slab is None)
    assert len(session.history.moments()) == 1, "edits of one tick leave one moment"


def test_without_obstacles_none_can_be_taken_away(server: viser.ViserServer, session: Session) -> None:
    wait(session, lambda s: tick(s) == 0)
    panel = ObstaclesPanel(server.gui, Desk(server, session))
    for left in (2, 1, 0):
        session.send(ApplyEvent(event=RemoveObstacle(index=0)))
        wait(session, lambda s, left=left: len(around(s).obstacles) == left)
    assert shown(panel, session.state)[0] == ("none",)
    with pytest.raises(InvalidInputError, match=r"no obstacle '1 cube'\. Standing: none"):
        panel.remove("1 cube")


def test_who_looks_back_sees_what_stood_there_then(session: Session) -> None:
    for _ in range(3):
        session.send(StepOnce())
    wait(session, lambda s: tick(s) == 3)
    session.send(ApplyEvent(event=RemoveObstacle(index=0)))
    wait(session, lambda s: len(around(s).obstacles) == 2)
    session.send(LookBack(t_s=0.0))
    state = wait(session, lambda s: s.looked_at is not None)
    assert len(around(state.shown).obstacles) == 3 and len(around(state).obstacles) == 2


@pytest.mark.parametrize("name", scenario_names())
def test_there_is_room_beside_every_belt_and_what_is_put_there_can_stand(name: str) -> None:
    with Episode(load_scenario(name), 2) as episode:
        now = next(episode.run())
        for kind in ("bleach_cleanser", "power_drill"):
            x_m, y_m = free_place(episode.scene, now)
            level = [T[:2, 3] for T in now.Ts_world_obstacle]
            assert all(np.hypot(*(at - (x_m, y_m))) >= FROM_OTHERS_M for at in level)
            episode.apply(AddObstacle(object=kind, x_m=x_m, y_m=y_m))
            now = episode.edited(now)
        assert now.obstacles[-2:] == ("bleach_cleanser", "power_drill")


def test_a_crowd_leaves_no_room() -> None:
    with Episode(load_scenario("ur5_linear"), 2) as episode:
        now = next(episode.run())
        rows = np.tile(np.eye(4), (2000, 1, 1))
        rows[:, :2, 3] = np.random.default_rng(0).uniform(-2.0, 2.0, size=(2000, 2))
        with pytest.raises(InvalidInputError, match="no free place"):
            free_place(episode.scene, replace(now, Ts_world_obstacle=rows))


def test_the_scene_shows_what_stands_around_now(server: viser.ViserServer) -> None:
    layer = ObstaclesLayer(server.scene, Untouched())
    nodes: Any = layer
    with Episode(load_scenario("ur5_linear_obstacles"), 2) as episode:
        before = next(episode.run())
        layer.begin(episode.scene)
        layer.draw(Picture(episode.scene, before, None, new_cycle=False))
        first = list(nodes._nodes)
        layer.draw(Picture(episode.scene, before, None, new_cycle=False))
        assert nodes._nodes == first and len(first) == 3
        episode.apply(RemoveObstacle(index=1))
        episode.apply(SetSlab(height_m=0.7))
        layer.draw(Picture(episode.scene, episode.edited(before), None, new_cycle=False))
        assert len(nodes._nodes) == 2
        x_m, y_m, _ = nodes._nodes[1].position
        np.testing.assert_allclose((x_m, y_m), before.Ts_world_obstacle[2, :2, 3], atol=1e-6)


@pytest.mark.parametrize(
    ("events", "words"),
    [
        ((RemoveObstacle(index=3),), "tick 0 removes obstacle 3, but this trial has 3 then"),
        (
            (RemoveObstacle(index=0), MoveObstacle(index=2, x_m=1.0, y_m=1.0)),
            "tick 1 moves obstacle 2, but .* has 2 then",
        ),
    ],
)
def test_edits_of_what_will_not_be_there_are_refused_before_the_trial_begins(
    events: tuple[Any, ...], words: str
) -> None:
    timed = tuple(TimedEvent(tick=i, event=event) for i, event in enumerate(events))
    scenario = load_scenario("ur5_linear_obstacles").model_copy(update={"events": timed})
    with pytest.raises(InvalidInputError, match=words):
        LiveEpisode(scenario, 0)


def test_edits_of_what_was_put_up_before_are_not_refused() -> None:
    events = (AddObstacle(object="cube", x_m=1.2, y_m=1.2), MoveObstacle(index=3, x_m=1.0, y_m=1.2))
    timed = tuple(TimedEvent(tick=i, event=event) for i, event in enumerate(events))
    scenario = load_scenario("ur5_linear_obstacles").model_copy(update={"events": timed})
    with LiveEpisode(scenario, 0) as episode:
        *_, last = (snapshot for snapshot, _ in zip(episode.run(), range(4), strict=False))
        np.testing.assert_allclose(last.Ts_world_obstacle[3, :2, 3], (1.0, 1.2), atol=1e-3)
