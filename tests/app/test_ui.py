"""Laws of layers and panels: every snapshot can be drawn, and what is drawn is where the snapshot says."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from typing import Any, cast

import numpy as np
import pytest
import trimesh
import viser

from app.commands import Restart
from app.reports import Crashed, Pace, Started, Traces
from app.session import Session
from app.state import SessionState
from app.ui import words
from app.ui.camera import viewpoint
from app.ui.desk import Desk
from app.ui.geometry import chevrons, ribbon, segments, thinned
from app.ui.layers import LAYERS, Layer, Picture
from app.ui.panels import View
from app.ui.panels.playback import LABELS, speed_label
from app.ui.panels.ranking import ranking_html
from app.ui.panels.scenario import ScenarioPanel
from app.ui.progress import WAIT_S, AutoNext, Tally
from app.ui.robot_parts import load_robot_parts
from app.ui.touch import Untouched
from app.view import SharedView
from backend.pipeline.values import Outcome
from backend.robots import ROBOTS
from backend.snapshot import SceneDescription, Snapshot
from tests.app.fake_episode import SCENARIOS, FakeEngine

NAMES = [name for name in SCENARIOS if name != "boom"]
ENGINE = FakeEngine()


@cache
def recorded(name: str) -> tuple[SceneDescription, list[Snapshot]]:
    episode = ENGINE.make_episode(Restart(scenario=name, overrides={}))
    return episode.scene, list(episode.run())


def draw_all(server: viser.ViserServer, name: str, ticks: slice) -> tuple[list[Layer], Snapshot]:
    scene, snapshots = recorded(name)
    layers: list[Layer] = [layer(server.scene, Untouched()) for layer in LAYERS]
    for layer in layers:
        layer.begin(scene)
    for snapshot in snapshots[ticks]:
        points = np.array([[0.0, 0.0, 0.1], [0.1, 0.0, 0.2], [0.2, 0.1, 0.3]])
        picture = Picture(scene, snapshot, Traces(points, None), new_cycle=True)
        for layer in layers:
            layer.draw(picture)
    return layers, snapshots[ticks][-1]


def node(server: viser.ViserServer, name: str) -> Any:
    handle = server.scene.get_handle_by_name(name)
    assert handle is not None, name
    return handle


@pytest.mark.parametrize("name", NAMES)
def test_every_layer_draws_every_kind_of_snapshot(server: viser.ViserServer, name: str) -> None:
    draw_all(server, name, slice(0, None, 25))


def test_things_stand_where_the_snapshot_says(server: viser.ViserServer) -> None:
    _, snapshot = draw_all(server, "ur5_linear", slice(0, 200, 40))
    np.testing.assert_allclose(node(server, "/object/body").position, snapshot.T_world_object.xyz_m)
    tray_top_m = node(server, "/conveyor/tray").position[2] + 0.01
    assert tray_top_m == pytest.approx(snapshot.T_world_tray.xyz_m[2])
    for i, T in enumerate(snapshot.Ts_world_obstacle):
        np.testing.assert_allclose(node(server, f"/obstacles/{i}").position, T[:3, 3])
    poses = load_robot_parts("ur5_robotiq").tree.link_poses(snapshot.joints_rad)
    for link in ("forearm_link", "wrist_3_link"):
        np.testing.assert_allclose(node(server, f"/robot/{link}").position, poses[link][:3, 3])


def test_the_shortlist_is_shown_best_to_last_and_the_picked_one_apart(server: viser.ViserServer) -> None:
    _, snapshot = draw_all(server, "ur5_linear", slice(0, 100, 7))
    assert snapshot.cycle is not None and snapshot.cycle.shortlist is not None and snapshot.cycle.picked is not None
    shortlist, picked = snapshot.cycle.shortlist, snapshot.cycle.picked
    hands = node(server, "/grasps/predicted/shortlist")
    shown = [i for i in shortlist.kept if i != picked.index]
    assert int(np.count_nonzero(hands.batched_scales)) == len(shown)
    expected = shortlist.candidates.Ts_object_grasp[shown][:, :3, 3]
    np.testing.assert_allclose(hands.batched_positions[: len(shown)], expected, atol=1e-6)
    np.testing.assert_allclose(node(server, "/grasps/predicted/picked").position, picked.T_object_grasp.xyz_m)
    assert len({tuple(color) for color in hands.batched_colors[: len(shown)]}) == len(shown)


class Cells(HTMLParser):
    """The words of a table, row by row."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self._open = False
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        self._open = tag in ("td", "th") or (self._open and tag == "span")

    def handle_data(self, data: str) -> None:
        if self._open:
            self.rows[-1][-1] += data

    def handle_endtag(self, tag: str) -> None:
        self._open = self._open and tag != "table"


def test_the_ranking_says_what_each_grasp_was_ranked_by_and_what_became_of_it() -> None:
    cycle = recorded("ur5_linear")[1][80].cycle
    assert cycle is not None and cycle.shortlist is not None and cycle.picked is not None
    short = replace(cycle.shortlist, rejected={**cycle.shortlist.rejected, cycle.shortlist.kept[1]: "<out> of reach"})
    html = ranking_html(cycle, short)
    heads, *rows = Cells(html).rows
    assert heads[1:5] == ["no.", "R cm", "M %", "way °"]
    assert [int(row[1]) for row in rows] == list(short.kept)
    assert short.reachability_m is not None and short.motion_quality is not None
    for row, i in zip(rows, short.kept, strict=True):
        assert float(row[2]) == pytest.approx(100 * short.reachability_m[i], abs=0.051)
        assert float(row[3]) == pytest.approx(100 * short.motion_quality[i], abs=0.51)
    ways = [short.joint_distance_rad.get(i) for i in short.kept]
    assert [row[4] for row in rows] == ["-" if way is None else f"{np.degrees(way):.0f}" for way in ways]
    assert [row[5] for row in rows] == ["picked", "<out> of reach"] + [""] * 8
    assert "20x others hold better in this motion" in html and "<out>" not in html
    plain = replace(short, reachability_m=None, motion_quality=None)
    assert Cells(ranking_html(cycle, plain)).rows[0][1:4] == ["no.", "score", "way °"]
    unscored = replace(plain, score=np.full(30, np.nan))
    assert len(Cells(ranking_html(cycle, unscored)).rows[1]) == 4


def test_what_a_cycle_does_not_have_is_not_shown(server: viser.ViserServer) -> None:
    layers, snapshot = draw_all(server, "ur5_linear", slice(0, 100, 7))
    assert snapshot.cycle is not None
    empty = replace(snapshot.cycle, prediction=None, shortlist=None, picked=None, plan=None)
    picture = Picture(recorded("ur5_linear")[0], replace(snapshot, cycle=empty), None, new_cycle=True)
    for layer in layers:
        layer.draw(picture)
    for name in ("/grasps/predicted", "/grasps/predicted/picked", "/prediction/ghost", "/prediction/way"):
        assert not node(server, name).visible, name


def test_a_layer_switched_off_stays_off_in_the_next_trial(server: viser.ViserServer) -> None:
    layers, _ = draw_all(server, "ur5_linear", slice(0, 1))
    for layer in layers:
        layer.show(False)
        layer.begin(recorded("ur5_linear_slab")[0])
    for name in (
        "/conveyor",
        "/robot",
        "/object",
        "/obstacles",
        "/prediction",
        "/grasps",
        "/plans",
        "/trail",
    ):
        assert not node(server, name).visible, name


def test_a_new_trial_leaves_nothing_of_the_old_one(server: viser.ViserServer) -> None:
    layers, _ = draw_all(server, "ur5_linear", slice(0, 1))
    for layer in layers:
        layer.begin(recorded("ur5_linear_slab")[0])
    assert server.scene.get_handle_by_name("/obstacles/0") is None
    draw_all(server, "ur5_linear_slab", slice(0, 1))
    assert server.scene.get_handle_by_name("/obstacles/slab") is not None


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_every_robot_can_be_drawn_by_the_joints_it_reports(robot: str) -> None:
    parts = load_robot_parts(robot)
    assert {part.link for part in parts.parts} <= set(parts.tree.links)
    assert all(np.isfinite(part.geometry.vertices).all() for part in parts.parts)
    assert all(part.geometry.faces.max() < len(part.geometry.vertices) for part in parts.parts)
    bounds = np.concatenate([part.geometry.vertices for part in parts.parts])
    assert np.abs(bounds).max() < 1.0


def test_arrows_point_along_the_belt_and_the_band_is_as_wide_as_the_tray() -> None:
    path = np.linspace([0.0, 0.0, 0.02], [1.0, 0.0, 0.02], 30)
    tips, tails = np.swapaxes(chevrons(path, spacing_m=0.1, size_m=0.02, lift_m=0.0), 0, 1)
    assert (tips[:, 0] > tails[:, 0]).all()
    band = ribbon(path, 0.12, 0.02)
    assert np.ptp(band.vertices[:, 1]) == pytest.approx(0.12)
    assert (band.vertices[:, 2] == 0.0).all()


def test_a_band_along_sharp_bends_covers_the_ground_beside_it_once() -> None:
    x = np.linspace(0.0, 1.0, 120)
    path = np.stack([x, 0.08 * np.sin(20.0 * x), np.full(120, 0.02)], axis=1)
    band = ribbon(path, 0.1, 0.02)
    corners = band.vertices[band.faces][:, :, :2]
    points = np.random.default_rng(0).uniform([0.05, -0.15], [0.95, 0.15], (20_000, 2))
    sides = np.roll(corners, -1, axis=1) - corners
    to_points = points[:, None, None] - corners
    over = sides[..., 0] * to_points[..., 1] - sides[..., 1] * to_points[..., 0]
    times = (over > 0.0).all(axis=2).sum(axis=1) + (over < 0.0).all(axis=2).sum(axis=1)
    away_m = np.linalg.norm(points[:, None] - path[:, :2], axis=2).min(axis=1)
    assert times.max() == 1
    assert (times[away_m < 0.048] == 1).mean() > 0.999
    assert not times[away_m > 0.052].any()


def test_thinning_moves_no_vertex_far_and_leaves_only_triangles() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    thin = thinned(ball, 0.01)
    assert len(thin.faces) < 0.2 * len(ball.faces)
    assert np.linalg.norm(thin.vertices, axis=1).min() > 0.1 - 0.01 * np.sqrt(3.0)
    assert (thin.area_faces > 0.0).all()


def test_segments_join_their_points() -> None:
    points = np.arange(12.0).reshape(4, 3)
    strokes = segments(points)
    np.testing.assert_array_equal(strokes[:, 0], points[:-1])
    np.testing.assert_array_equal(strokes[:, 1], points[1:])
    assert segments(points[:1]).shape == (1, 2, 3)


@pytest.mark.parametrize("name", NAMES)
def test_the_camera_stands_above_the_floor_and_sees_the_whole_belt(name: str) -> None:
    scene, _ = recorded(name)
    position, look_at = viewpoint(scene)
    axis = (look_at - position) / np.linalg.norm(look_at - position)
    rays = scene.belt_path_world - position
    angles = np.arccos(rays @ axis / np.linalg.norm(rays, axis=1))
    assert position[2] > 0.5
    assert angles.max() < np.pi / 4


def test_speed_labels_and_speeds_are_one_to_one() -> None:
    assert all(speed_label(speed) == label for label, speed in LABELS.items())
    assert list(LABELS) == ["1/8", "1/4", "1/2", "1", "2", "4", "8", "max"]


def state_with(outcome: Outcome | None, run: int = 1, **fields: Any) -> SessionState:
    scene, snapshots = recorded("ur5_linear")
    restart = Restart(scenario="ur5_linear", overrides={})
    state = SessionState(
        status="running",
        info=ENGINE.describe(restart),
        restart=restart,
        loading=False,
        pace=Pace(paused=False, speed=1.0, real_time_factor=1.0),
        started=Started(run, restart, scene),
        snapshot=replace(snapshots[-1], outcome=outcome),
    )
    return replace(state, **fields)


GRASPED = Outcome(strict=True, authors=True, reason=None)
DROPPED = Outcome(strict=False, authors=False, reason="dropped")


def test_every_trial_is_counted_once() -> None:
    good, bad = state_with(GRASPED), state_with(DROPPED, run=2)
    tally = Tally()
    for state in (state_with(None), good, good, bad, bad):
        tally = tally.after(state)
    assert (tally.ended, tally.grasped) == (2, 1)


def test_another_problem_starts_a_new_count() -> None:
    tally = Tally().after(state_with(GRASPED))
    other = Restart(scenario="ur5_linear", overrides={"object": "cube"})
    tally = tally.after(state_with(DROPPED, run=2, restart=other))
    assert (tally.ended, tally.grasped) == (1, 0)


def test_the_next_trial_waits_for_the_outcome_to_be_read() -> None:
    auto_next, over = AutoNext(), state_with(GRASPED)
    assert auto_next.remaining_s(state_with(None), 10.0) is None
    assert auto_next.remaining_s(over, 20.0) == WAIT_S
    assert auto_next.remaining_s(over, 20.0 + WAIT_S) == 0.0
    paused = replace(over, pace=Pace(paused=True, speed=1.0, real_time_factor=0.0))
    assert auto_next.remaining_s(paused, 30.0) is None
    off = replace(over, view=SharedView(auto_next=False))
    assert auto_next.remaining_s(off, 40.0) is None


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.names: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)


def test_whatever_comes_from_outside_is_escaped() -> None:
    evil = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    crash = Crashed(evil, evil)
    pieces = (
        words.banner(evil, evil, (0, 0, 0)),
        words.facts([(evil, evil)]),
        words.bars([(evil, 0.5, evil)], (0, 0, 0)),
        words.note(evil),
        words.ranking((evil,), [((0, 0, 0), (evil,))]),
        words.crash_text(crash.cause, crash.traceback),
    )
    for piece in pieces:
        tags = Tags()
        tags.feed(piece)
        assert not {"script", "img"} & set(tags.names), piece


def test_every_outcome_has_plain_words() -> None:
    assert words.outcome_words(GRASPED) == ("Grasped", "Lifted and held by the hand alone.")
    for reason, text in words.REASONS.items():
        headline, sentence = words.outcome_words(Outcome(False, False, reason))
        assert headline == "Not grasped" and sentence == text
    assert words.outcome_words(replace(DROPPED, detail="It slid."))[1] == "It slid."
    assert cast(object, words.outcome_color(GRASPED)) != words.outcome_color(DROPPED)


def test_objects_that_come_and_go_are_on_offer_and_so_is_the_one_tried(server: viser.ViserServer) -> None:
    class Growing(FakeEngine):
        names: tuple[str, ...] = ("cube", "tomato_soup_can")

        def object_names(self) -> tuple[str, ...]:
            return self.names

    engine = Growing()
    session = Session(engine, Restart(scenario="ur5_linear", overrides={"object": "cube"}))
    panel = ScenarioPanel(server.gui, Desk(server, session))
    shown: Any = panel._object  # pyright: ignore[reportPrivateUsage]
    for names in (("cube", "tomato_soup_can", "mug"), ("tomato_soup_can",)):
        engine.names = names
        panel.show(View(session.state, session.state, (), Tally(), None, ""))
        assert set(shown.options) == {*names, "cube"} and shown.value == "cube"
