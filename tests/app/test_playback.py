"""Laws of the button that plays and pauses."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

import pytest
import viser

from app.commands import SetPaused, SetSpeed
from app.session import Session
from app.state import SessionState
from app.ui.desk import Desk
from app.ui.panels.panel import View
from app.ui.panels.playback import PlaybackPanel
from app.ui.progress import Tally
from tests.app.fake_episode import LINEAR, FakeEngine
from tests.app.sessions import tick, wait


@contextmanager
def ended(*, auto_next: bool) -> Generator[Session]:
    """A session whose trial is over."""
    session = Session(FakeEngine(), LINEAR, auto_next=auto_next)
    session.start()
    session.send(SetSpeed(speed=None))
    wait(session, lambda s: s.over)
    yield session
    session.close()


def label(panel: PlaybackPanel, state: SessionState) -> str:
    panel.show(View(state, state, (), Tally(), None, ""))
    buttons: Any = panel._time  # pyright: ignore[reportPrivateUsage]
    return str(buttons.options[0])


@pytest.mark.parametrize("paused", [False, True])
def test_at_the_end_it_plays_the_same_again(server: viser.ViserServer, paused: bool) -> None:
    with ended(auto_next=False) as session:
        session.send(SetPaused(paused=paused))
        state = wait(session, lambda s: s.pace.paused is paused)
        panel = PlaybackPanel(server.gui, Desk(server, session))
        assert label(panel, state) == "Play"
        assert panel.toggle() == "Trial restarted with seed 0."
        again = wait(session, lambda s: not s.loading and not s.over and tick(s) > 3)
        assert not again.pace.paused and again.restart == state.restart


def test_where_another_trial_follows_it_is_held_up(server: viser.ViserServer) -> None:
    with ended(auto_next=True) as session:
        panel = PlaybackPanel(server.gui, Desk(server, session))
        assert label(panel, session.state) == "Pause"
        assert panel.toggle() is None
        assert wait(session, lambda s: s.pace.paused).over
