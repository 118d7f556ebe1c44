"""Laws of the real engine behind the page: what cannot come to pass is refused, what is left can be replayed."""

from pathlib import Path

import pytest

from app.backend_engine import BackendEngine
from app.commands import Restart
from backend.errors import InvalidInputError
from backend.events import MoveObstacle, SetBeltRate, TimedEvent
from backend.experiments.trial import run_trial
from backend.record import load_trace

ENGINE = BackendEngine()


def test_an_edit_of_an_obstacle_that_is_not_there_is_refused_before_the_trial() -> None:
    events = (TimedEvent(tick=5, event=MoveObstacle(index=0, x_m=0.3, y_m=0.3)),)
    with pytest.raises(InvalidInputError, match="tick 5 moves obstacle 0, but this trial has 0"):
        ENGINE.make_episode(Restart(scenario="ur5_linear", overrides={"object": "cube"}, events=events))


def test_what_a_trial_leaves_repeats_it_bit_for_bit(tmp_path: Path) -> None:
    events = (TimedEvent(tick=4, event=SetBeltRate(rate=0.5)),)
    short = {"object": "cube", "timing.timeout_s": 1.0}
    episode = ENGINE.make_episode(Restart(scenario="ur5_linear", seed=3, overrides=short, events=events))
    *_, last = episode.run()
    left = episode.keepsake()
    episode.close()
    path = tmp_path / "trial.npz"
    path.write_bytes(left.trace)
    again = run_trial(load_trace(path).scenario)
    assert again.fingerprint == left.record["fingerprint"] == last.fingerprint
