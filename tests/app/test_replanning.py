"""Laws of what is said of a new plan against the one before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.commands import Restart
from app.reports import Traces
from app.ui.replanning import change, change_words
from backend.pipeline.values import CycleResult, Plan
from backend.trajectory import Path
from tests.app.fake_episode import FakeEngine


def a_cycle() -> CycleResult:
    episode = FakeEngine().make_episode(Restart(scenario="ur5_linear", overrides={}))
    cycle = [snapshot for snapshot, _ in zip(episode.run(), range(40), strict=False)][-1].cycle
    assert cycle is not None
    return cycle


CYCLE = a_cycle()
SEED = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])


def planned(points: list[list[float]], seed: np.ndarray | None = SEED) -> CycleResult:
    plan = Plan(Path(np.array(points)), 0, "straight", 1)
    return replace(CYCLE, plan=plan, seed_path=None if seed is None else Path(seed))


def test_a_bend_is_told_by_how_far_it_leads_away_and_how_long_it_is() -> None:
    hand = Traces(np.array([[0.0, 0.0, 0.0], [0.2, 0.03, 0.0]]), np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0]]))
    cycle = planned([[0.0, 0.0], [1.0, 0.5], [2.0, 0.0]])
    found = change(cycle, hand)
    assert found is not None
    assert found.apart == (pytest.approx(0.5), pytest.approx(0.03))
    assert found.before == (2.0, pytest.approx(0.2)) and found.after[0] == pytest.approx(2 * np.hypot(1.0, 0.5))
    words = change_words(cycle, hand)
    assert "departs from" in words and "0.50 rad or 3.0 cm apart" in words and "2.24 rad or 20.2 cm" in words
    assert "2.00 rad or 20.0 cm" in words
    assert "is what was left of the one before: 2.00 rad" in change_words(planned([[0.0, 0.0], [2.0, 0.0]]), hand)
    assert "follows" in change_words(planned([[0.0, 0.0], [1.0, 0.05], [2.0, 0.0]]), hand)


def test_where_there_is_nothing_to_compare_that_is_said() -> None:
    hand = Traces(np.zeros((2, 3)), None)
    assert "first plan" in change_words(planned([[0.0, 0.0], [1.0, 0.0]], None), hand)
    refused = replace(CYCLE, plan=None, refused_by="plan", why="the start is blocked")
    assert change_words(refused, None) == "No new plan: the start is blocked."
    assert change_words(replace(refused, refused_by=None), None) == "No plan yet."
    assert change(CYCLE, None) is None
