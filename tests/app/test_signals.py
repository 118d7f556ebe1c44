"""Laws of what is plotted: figures come from what the page has seen, and the truth only once it is known."""

from __future__ import annotations

import re
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.history import Moment
from app.reports import Sight
from app.ui.plot import HEIGHT, STEPS, WIDTH, highest, nice_top, plot_html
from app.ui.signals import MOST, Line, Plot, cycles_in, joint_speeds, plots, prediction_errors, thinned, true_positions
from backend.pose import Pose
from backend.robots import ROBOTS
from tests.app.fake_episode import LINEAR, FakeEngine

MOMENTS = [Moment(snapshot, None) for snapshot in FakeEngine().make_episode(LINEAR).run()]
LIMITS_RPS = ROBOTS["ur5_robotiq"].profiles["paper"].velocity_rps
RIDING_S = 375 / 30
"""In the fake trial the fingers begin to close then."""


def drawn(moments: list[Moment] = MOMENTS, other: str = "") -> dict[str, Plot]:
    return {plot.title: plot for plot in plots(moments, LIMITS_RPS, other)}


def test_distances_are_those_of_the_snapshots_and_to_the_pregrasp_only_on_the_way() -> None:
    pregrasp, to_object = drawn()["Hand to"].lines
    for moment in MOMENTS[1::50]:
        snapshot, hand_m = moment.snapshot, moment.snapshot.T_world_tcp.xyz_m
        i = int(np.argmin(np.abs(to_object.t_s - snapshot.t_s)))
        if to_object.t_s[i] != snapshot.t_s:
            continue
        assert to_object.values[i] == pytest.approx(100 * np.linalg.norm(hand_m - snapshot.T_world_object.xyz_m))
        assert snapshot.cycle is not None and snapshot.cycle.picked is not None
        if snapshot.phase in ("watch", "move"):
            away_m = np.linalg.norm(hand_m - snapshot.cycle.picked.T_world_pregrasp.xyz_m)
            assert pregrasp.values[i] == pytest.approx(100 * away_m)
        else:
            assert np.isnan(pregrasp.values[i])


def test_an_error_is_known_when_its_time_has_come_and_only_while_the_object_rides() -> None:
    for seen in (MOMENTS[:200], MOMENTS):
        now_s = min(seen[-1].t_s, RIDING_S)
        for line, ahead_s in zip(prediction_errors(seen, cycles_in(seen)), (0.0, 1.0, 2.0), strict=True):
            known = np.isfinite(line.values)
            assert known.any()
            # the fake cycle predicts from a tick on, in a straight line at the belt's own speed: so nothing is wrong
            np.testing.assert_allclose(line.values[known], 0.0, atol=1e-6)
            due = (line.t_s + ahead_s <= now_s - 1 / 30 + 1e-9) & (line.t_s + ahead_s >= 0.0)
            assert (known == due)[np.abs(line.t_s + ahead_s - now_s) > 0.05].all()


def test_an_error_is_the_distance_of_what_was_said_from_what_came() -> None:
    def moved(moment: Moment) -> Moment:
        T = Pose.of((0.003, 0.0, 0.004)) @ moment.snapshot.T_world_object
        return Moment(replace(moment.snapshot, T_world_object=T), None)

    line = prediction_errors([moved(moment) for moment in MOMENTS], cycles_in(MOMENTS))[1]
    np.testing.assert_allclose(line.values[np.isfinite(line.values)], 5.0, atol=1e-6)


def test_between_two_moments_the_truth_is_on_the_line_and_in_a_gap_it_is_unknown() -> None:
    snapshots = [moment.snapshot for moment in MOMENTS]
    at_s = np.array([-1.0, 1.0 + 1 / 60, 5.0, 99.0])
    found = true_positions(snapshots, at_s)
    assert np.isnan(found[[0, 3]]).all()
    half = (snapshots[30].T_world_object.xyz_m + snapshots[31].T_world_object.xyz_m) / 2
    np.testing.assert_allclose(found[1], half, atol=1e-9)
    assert np.isnan(true_positions([*snapshots[:100], *snapshots[200:]], at_s)[2]).all()
    assert np.isnan(true_positions([], at_s)).all()


def test_joint_speeds_are_shares_of_the_limits() -> None:
    lines = joint_speeds([moment.snapshot for moment in MOMENTS], LIMITS_RPS)
    assert len(lines) == len(LIMITS_RPS)
    t_s = lines[0].t_s - 1 / 60  # the mean over a tick is the derivative in its middle
    true_rps = 0.2 * np.abs(np.cos(0.5 * t_s))
    np.testing.assert_allclose(lines[0].values, 100 * true_rps / LIMITS_RPS[0], rtol=1e-3)
    still = [MOMENTS[50].snapshot] * 3
    assert all((line.values == 0.0).all() for line in joint_speeds(still, LIMITS_RPS))


def test_every_cycle_is_counted_once_and_its_rooms_add_up() -> None:
    cycles = cycles_in(MOMENTS)
    assert [cycle.number for cycle in cycles] == list(range(1, 101))
    plot = drawn()["Time per room"]
    shown = [sum(took_s for room, took_s in cycle.room_s.items() if room != "sense") for cycle in cycles]
    assert highest(plot) == pytest.approx(1e3 * max(shown))


def test_of_the_one_compared_with_the_distance_is_shown() -> None:
    pairs = [replace(moment, beside=Sight(MOMENTS[0].snapshot, None)) for moment in MOMENTS]
    assert [line.name for line in drawn(pairs, "baseline")["Hand to"].lines] == [
        "pregrasp",
        "object",
        "object, baseline",
    ]


def test_few_samples_span_all_there_is() -> None:
    many = [Moment(replace(MOMENTS[0].snapshot, tick=k, t_s=k / 30), None) for k in range(1800)]
    few = thinned(many)
    assert MOST <= len(few) <= MOST + 2 and (few[0], few[-1]) == (many[0], many[-1])
    assert thinned(MOMENTS[:3]) == MOMENTS[:3] and thinned([]) == []


def test_nothing_seen_is_nothing_drawn() -> None:
    for plot in plots([], LIMITS_RPS):
        assert "<svg" in plot_html(plot, (0.0, 15.0), 0.0, looked_at=False)


@given(st.floats(1e-6, 1e9))
def test_a_scale_ends_at_a_round_figure_not_far_above_what_is_shown(value: float) -> None:
    top = nice_top(value)
    assert value * (1 - 1e-6) <= top <= 1.5 * value * (1 + 1e-6)
    assert float(f"{top:.6e}".partition("e")[0]) in STEPS


def test_a_burst_does_not_hide_the_rest() -> None:
    values = np.array([1.0] * 99 + [1000.0])
    line = Line("x", (0, 0, 0), np.arange(100.0), values)
    assert highest(Plot("y", "ms", (line,))) == 1000.0 and highest(Plot("y", "ms", (line,), bursts=True)) == 1.0


def test_a_line_has_gaps_where_nothing_is_known_and_figures_are_of_the_moment_shown() -> None:
    line = Line("x", (0, 0, 0), np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 50.0, np.nan, 100.0]))
    html = plot_html(Plot("y", "cm", (line,), limit=80.0), (0.0, 4.0), 1.2, looked_at=True)
    assert f'd="M0 {HEIGHT}L{WIDTH // 4} {HEIGHT // 2}M{3 * WIDTH // 4} 0"' in html
    assert f"M0 20H{WIDTH}" in html and f"M300 0V{HEIGHT}" in html
    assert re.search(r">50</span>", html) and "100 cm" in html and 'data-strip="0 4"' in html
    assert np.isnan(line.at(-1.0)) and np.isnan(line.at(2.5)) and line.at(9.0) == 100.0
    assert "M300" not in plot_html(Plot("y", "cm", (line,)), (0.0, 4.0), 1.2, looked_at=False)


def test_parts_stand_on_each_other() -> None:
    t_s = np.array([0.0, 1.0])
    parts = (Line("a", (0, 0, 0), t_s, np.array([2.0, 2.0])), Line("b", (1, 1, 1), t_s, np.array([3.0, 8.0])))
    plot = Plot("y", "ms", parts, stacked=True)
    assert highest(plot) == 10.0
    paths = re.findall(r'd="(M[^"]+Z)"', plot_html(plot, (0.0, 1.0), 1.0, looked_at=False))
    assert paths == ["M0 80L1000 80L1000 100L0 100Z", "M0 50L1000 0L1000 80L0 80Z"]


def test_a_minute_is_drawn_in_little_time_and_on_little_wire() -> None:
    """A bound of bytes before compression, and of time far above what it takes."""
    begun_s = time.perf_counter()
    html = "".join(plot_html(plot, (0.0, 20.0), 10.0, looked_at=True) for plot in plots(MOMENTS, LIMITS_RPS))
    assert len(html) < 40_000 and time.perf_counter() - begun_s < 1.0
