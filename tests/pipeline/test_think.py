"""What thinking is charged, in each of the three ways."""

import pytest

from backend.pipeline.think import ThinkTime
from backend.scenario import TimingConfig


def test_a_budget_is_charged_whatever_the_cycle_did():
    think = ThinkTime(TimingConfig(think="budget", budget_s=0.2))
    assert think.expected_s(0) == think.expected_s(40) == think.refused_s(3) == think.approach_s() == 0.2
    assert not think.overran(10.0)


def test_the_papers_cycle_of_twenty_ik_calls_costs_475_milliseconds():
    think = ThinkTime(TimingConfig(think="paper"))
    assert think.expected_s(20) == pytest.approx(0.475)
    assert think.refused_s(0) == pytest.approx(0.135)
    assert think.approach_s() == 0.0


def test_measured_thought_learns_how_long_it_takes():
    think = ThinkTime(TimingConfig(think="measured", budget_s=0.1))
    assert think.expected_s() == 0.1
    assert think.overran(0.2)
    assert think.expected_s() == pytest.approx(0.25)
    assert not think.overran(0.2)
    for _ in range(50):
        think.overran(0.01)
    assert think.expected_s() < 0.02
