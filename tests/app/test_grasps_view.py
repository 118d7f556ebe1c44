"""Laws of how grasps are shown: the funnel counts what there is, small hands stand where their grasps are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from app.commands import Restart
from app.ui import palette
from app.ui.funnel import card_rows, funnel, ranges, rejections, side_of
from app.ui.layers.all_grasps import BACK_M, SCALE, AllGraspsLayer
from app.ui.layers.draggable import on_floor
from app.ui.layers.layer import Picture
from app.ui.palette import rank_color
from app.ui.panels.ranking import card_html, funnel_html
from app.ui.scores import SCORES
from app.ui.touch import Untouched
from app.view import SharedView
from backend.pipeline.values import Candidate, CycleResult, Shortlist
from backend.pose import Pose
from tests.app.fake_episode import FakeEngine


def a_cycle() -> tuple[CycleResult, Shortlist, Candidate]:
    episode = FakeEngine().make_episode(Restart(scenario="ur5_linear", overrides={}))
    cycle = [snapshot for snapshot, _ in zip(episode.run(), range(80), strict=False)][-1].cycle
    assert cycle is not None and cycle.shortlist is not None and cycle.picked is not None
    return cycle, cycle.shortlist, cycle.picked


CYCLE, SHORT, PICKED = a_cycle()


def counts(short: Shortlist, picked: Candidate | None = PICKED) -> dict[str, int]:
    return {stage.name: stage.count for stage in funnel(short, picked)}


def test_the_funnel_counts_every_room_and_leaves_out_what_was_not_asked() -> None:
    assert SHORT.reachability_m is not None
    positive = int((SHORT.reachability_m > 0).sum())
    whole = {"in the database": 30, "reachable": positive, "shortlisted": 10, "solved by IK": 10, "picked": 1}
    assert counts(SHORT) == whole and list(counts(SHORT)) == list(whole)
    refused = replace(SHORT, rejected={**SHORT.rejected, SHORT.kept[3]: "pregrasp out of reach"})
    assert counts(refused, None) == {**whole, "solved by IK": 9, "picked": 0}
    by_ik = replace(SHORT, reachability_m=None, motion_quality=None, score=np.where(np.arange(30) < 12, 1.0, np.nan))
    assert counts(by_ik)["reachable"] == 12
    for unasked in (replace(SHORT, reachability_m=None), replace(by_ik, score=np.full(30, np.nan))):
        assert "reachable" not in counts(unasked)
    assert "30" in funnel_html(CYCLE, SHORT) and "reachable" in funnel_html(CYCLE, SHORT)


def test_every_rejected_grasp_is_listed_once_under_its_reason() -> None:
    reasons = {
        0: "grasp out of reach by about 3.1 cm",
        1: "grasp out of reach by about 7 cm; others",
        5: "in collision",
    }
    groups = rejections(replace(SHORT, rejected=reasons))
    assert groups == [("grasp out of reach", [0, 1]), ("in collision", [5])]


@given(st.sets(st.integers(0, 120)))
def test_ranges_name_every_number_and_no_other(numbers: set[int]) -> None:
    text = ranges(sorted(numbers))
    named = [part.split("-") for part in text.split(", ") if part]
    assert sorted(i for run in named for i in range(int(run[0]), int(run[-1]) + 1)) == sorted(numbers)


def test_a_card_says_where_from_how_good_and_what_became_of_it() -> None:
    picked, spare = dict(card_rows(SHORT, PICKED.index, PICKED)), dict(card_rows(SHORT, SHORT.kept[1], PICKED))
    other = dict(card_rows(SHORT, next(iter(SHORT.rejected)), PICKED))
    assert (picked["Became"], picked["Rank"]) == ("picked", "1 of 10") and spare["Became"] == "a spare"
    assert (other["Rank"], other["Joint distance, °"]) == ("not shortlisted", "-")
    assert other["Became"] == "others hold better in this motion"
    assert "Click a hand" in card_html(CYCLE, SHORT, None) and "Click a hand" in card_html(CYCLE, SHORT, 99)


@pytest.mark.parametrize(
    ("rpy", "side"),
    [
        ((np.pi, 0.0, 0.3), "above"),
        ((0.0, 0.0, 0.0), "below"),
        ((0.0, np.pi / 2, 0.0), "-x"),
        ((np.pi / 2, 0.0, 0.0), "+y"),
    ],
)
def test_the_side_is_opposite_to_where_the_hand_points(rpy: tuple[float, float, float], side: str) -> None:
    assert side_of(Pose.from_xyz_rpy((0.0, 0.0, 0.1), rpy)) == side


def test_colours_rank_and_grade_and_grey_out_what_nobody_asked() -> None:
    by_rank = SCORES["Rank"](SHORT)
    assert [by_rank[i] for i in SHORT.kept] == [rank_color(rank, 10) for rank in range(10)]
    assert {by_rank[i] for i in SHORT.rejected} == {palette.QUIET}
    assert SHORT.reachability_m is not None
    graded = SCORES["Reachability"](SHORT)
    assert [color == palette.BAD for color in graded] == (SHORT.reachability_m <= 0.0).tolist()
    assert set(SCORES["Reachability"](replace(SHORT, reachability_m=None))) == {palette.QUIET}
    best = SCORES["Lift success"](replace(SHORT, candidates=replace(SHORT.candidates, quality=np.ones(30))))
    assert set(best) == {palette.RANKS[0]}


def test_small_hands_stand_around_the_object_and_the_chosen_one_at_its_grasp(server: viser.ViserServer) -> None:
    episode = FakeEngine().make_episode(Restart(scenario="ur5_linear", overrides={}))
    layer = AllGraspsLayer(server.scene, Untouched())
    layer.begin(episode.scene)
    snapshot = replace(next(iter(episode.run())), cycle=CYCLE)
    layer.draw(Picture(episode.scene, snapshot, None, new_cycle=True))
    hands: Any = server.scene.get_handle_by_name("/all_grasps/predicted/hands")
    Ts = SHORT.candidates.Ts_object_grasp
    np.testing.assert_allclose(hands.batched_positions, Ts[:, :3, 3] - BACK_M * Ts[:, :3, 2], atol=1e-6)
    assert hands.batched_scales[list(SHORT.kept)].max() == 0.0
    np.testing.assert_allclose(hands.batched_scales[list(SHORT.rejected)], SCALE, rtol=1e-6)
    chosen = max(SHORT.rejected)
    layer.draw(Picture(episode.scene, snapshot, None, new_cycle=True, view=SharedView(grasp=chosen)))
    assert hands.batched_scales[chosen] == 1.0
    np.testing.assert_allclose(hands.batched_positions[chosen], Ts[chosen, :3, 3], atol=1e-6)


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.0, 0.4))
def test_what_is_dragged_follows_the_line_of_sight(x: float, y: float, height_m: float) -> None:
    camera, target = np.array([2.0, 1.5, 1.2]), np.array([x, y, height_m])
    pointer = camera + 0.37 * (target - camera)
    found = on_floor(camera, pointer, height_m)
    assert found is not None
    np.testing.assert_allclose(found, target[:2], atol=1e-9)


def test_a_look_along_the_floor_or_away_from_it_says_nothing() -> None:
    camera = np.array([2.0, 0.0, 1.0])
    assert on_floor(camera, camera + np.array([1.0, 0.0, 0.001]), 0.0) is None
    assert on_floor(camera, camera + np.array([0.0, 0.0, 1.0]), 0.0) is None
    assert on_floor(camera, camera, 0.0) is None
