"""Laws of films: every pixel shows what is nearest there, everything is in the picture, and files are whole."""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from backend.cli import main
from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.film.camera import Camera
from backend.film.caption import Caption, words_of
from backend.film.film import LAST_S, pictures, shown
from backend.film.picture import Painter, Pixels
from backend.film.raster import NOTHING, Ints, cover
from backend.film.takes import Takes
from backend.film.writing import write_film
from backend.objects import load_object
from backend.pipeline.values import Outcome
from backend.pose import Array
from backend.scenario import load_scenario, with_overrides
from backend.snapshot import SceneDescription, Snapshot

SIZE = 24
ffmpeg: Any = imageio_ffmpeg
PLACES = st.floats(-10.0, SIZE + 10.0)
CORNERS = st.lists(st.tuples(PLACES, PLACES, st.floats(0.1, 2.0)), min_size=6, max_size=6)


def covered(corners: Array, faces: list[tuple[int, int, int]]) -> tuple[Array, Ints]:
    nearness, which = np.zeros((SIZE, SIZE)), np.full((SIZE, SIZE), NOTHING, dtype=np.int32)
    cover(corners, np.array(faces, dtype=np.int32), np.zeros(len(faces), dtype=np.bool_), nearness, which)
    return nearness, which


@settings(max_examples=40)
@given(CORNERS)
def test_a_pixel_shows_the_nearest_triangle_over_its_middle(points: list[tuple[float, float, float]]):
    corners = np.array(points)
    nearness, which = covered(corners, [(0, 1, 2), (3, 4, 5)])
    for row in range(SIZE):
        for column in range(SIZE):
            expected = [NOTHING, 0.0]
            for face in (0, 1):
                a, b, c = corners[3 * face : 3 * face + 3]
                area = np.linalg.det([b[:2] - a[:2], c[:2] - a[:2]])
                if abs(area) < 1e-3:
                    return
                place = np.array([column + 0.5, row + 0.5])
                v, w = np.linalg.solve(np.array([b[:2] - a[:2], c[:2] - a[:2]]).T, place - a[:2])
                shares = np.array([1.0 - v - w, v, w])
                if np.abs(shares).min() < 1e-6:
                    return
                near = float(shares @ (a[2], b[2], c[2]))
                if (shares > 0.0).all() and near > expected[1]:
                    expected = [face, near]
            assert which[row, column] == expected[0]
            assert nearness[row, column] == pytest.approx(expected[1])


def test_what_is_behind_the_eye_is_not_seen():
    triangle = np.array([(2.0, 2.0, 1.0), (20.0, 2.0, 1.0), (2.0, 20.0, -1.0)])
    assert (covered(triangle, [(0, 1, 2)])[1] == NOTHING).all()


def test_a_camera_sees_what_it_looks_at_in_the_middle_and_up_is_up():
    camera = Camera(np.array([2.0, 1.0, 1.5]), np.array([0.2, 0.0, 0.1]), 640, 360)
    aim, above, nearer = camera.project(camera.aim_m + np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 0.2), (0.3, 0.2, 0.0)]))
    assert aim[:2] == pytest.approx((320.0, 180.0))
    assert above[0] == pytest.approx(320.0) and above[1] < 180.0
    assert nearer[2] > aim[2] == pytest.approx(1.0 / np.linalg.norm(camera.eye_m - camera.aim_m))


def begun(name: str, *overrides: str) -> tuple[SceneDescription, Snapshot]:
    with Episode(with_overrides(load_scenario(name), overrides), 3) as episode:
        return episode.scene, next(episode.run())


@pytest.fixture(scope="module")
def linear() -> tuple[SceneDescription, Snapshot]:
    return begun("ur5_linear")


NAMES = ("ur5_linear_obstacles", "mico_linear_slab", "ur5_circular", "mico_sinusoidal")


@pytest.mark.parametrize("name", NAMES)
def test_object_and_obstacles_are_where_they_are_and_above_the_caption(name: str):
    scene, first = begun(name)
    painter = Painter(scene, first, 640, 360)
    picture = painter.paint(first).astype(int)
    assert picture.shape == (360, 640, 3)
    for body, T in (
        (scene.object, first.T_world_object.matrix),
        *zip(scene.obstacles, first.Ts_world_obstacle, strict=True),
    ):
        shape = load_object(body)
        middle = T[:3, :3] @ shape.center_of_mass_m + T[:3, 3]
        x, y, _ = painter.pixel_of(middle)
        assert 0 < x < 640 and 0 < y < 360 * 0.9
        near = picture[int(y) - 4 : int(y) + 5, int(x) - 4 : int(x) + 5].reshape(-1, 3)
        hue = np.array(shape.color_rgb) / np.linalg.norm(shape.color_rgb)
        likeness = (near / np.linalg.norm(near, axis=1, keepdims=True)) @ hue
        assert likeness.max() > 0.98, body


def test_an_object_throws_a_shadow_on_the_floor_and_moves_with_its_pose(linear: tuple[SceneDescription, Snapshot]):
    scene, first = linear
    painter = Painter(scene, first, 320, 180)
    lifted = first.T_world_object.matrix.copy()
    lifted[:3, 3] += (0.25, 0.0, 0.15)
    high = painter.paint(replace(first, T_world_object=type(first.T_world_object)(lifted))).astype(int)
    low = painter.paint(first).astype(int)
    x, y, _ = painter.pixel_of(lifted[:3, 3])
    hue = np.array(load_object(scene.object).color_rgb)
    here = high[int(y) - 6 : int(y) + 1, int(x) - 3 : int(x) + 4].reshape(-1, 3)
    assert np.abs(here - hue).sum(axis=1).min() < 150 < np.abs(low[int(y) - 3, int(x)] - hue).sum()
    darker = (low - high).max(axis=2) > 25
    grey = np.ptp(high, axis=2) < 12
    assert (darker & grey).sum() > 10


def test_the_same_moment_gives_the_same_picture(linear: tuple[SceneDescription, Snapshot]):
    scene, first = linear
    one, other = (Painter(scene, first, 160, 90).paint(first) for _ in range(2))
    assert np.array_equal(one, other)


def moments_of(first: Snapshot, count: int) -> tuple[Snapshot, ...]:
    outcome = Outcome(strict=False, authors=False, reason="belt_end", detail="")
    return tuple(
        replace(first, tick=i, t_s=i / 30.0, outcome=outcome if i == count - 1 else None) for i in range(count)
    )


@pytest.mark.parametrize(("fps", "speed"), [(30.0, 1.0), (15.0, 1.0), (100 / 6, 2.0), (30.0, 0.5)])
def test_time_passes_as_it_is_asked_to_and_the_end_stays(
    linear: tuple[SceneDescription, Snapshot], fps: float, speed: float
):
    takes = Takes(linear[0], moments_of(linear[1], 91))
    moments = shown(takes, fps, speed)
    stay = round(LAST_S * fps)
    assert [moment.tick for moment in moments[-stay:]] == [90] * stay
    for k, moment in enumerate(moments[:-stay]):
        assert 0.0 <= moment.t_s - k * speed / fps + 1e-9 < 1 / 30 + 1e-9
    assert len(moments) - stay == pytest.approx(3.0 / speed * fps, abs=1)


def test_the_caption_says_phase_time_and_outcome(linear: tuple[SceneDescription, Snapshot]):
    first, last = moments_of(linear[1], 2)
    assert words_of(first)[0] == "Watching" and words_of(last)[0] == "Not grasped: belt end"
    scenario = load_scenario("ur5_linear")
    for width in (160, 640):
        blank = np.full((width * 9 // 32 * 2, width, 3), 200, dtype=np.uint8)
        captioned = Caption(scenario, 3, blank.shape[0]).below(blank, first)
        changed = np.argwhere((captioned != blank).any(axis=2))
        assert changed[:, 0].min() > 0.85 * len(blank)
        assert not np.array_equal(captioned, Caption(scenario, 3, blank.shape[0]).below(blank, last))


def squares() -> list[Pixels]:
    out: list[Pixels] = []
    for i in range(20):
        picture = np.full((90, 160, 3), 240, dtype=np.uint8)
        picture[30:60, 5 * i : 5 * i + 30] = (200, 30, 30)
        out.append(picture)
    return out


def test_a_gif_has_every_picture_for_as_long_as_it_is_shown(tmp_path: Path):
    write_film(tmp_path / "x.gif", squares(), 100 / 6)
    with Image.open(tmp_path / "x.gif") as film:
        count: int = getattr(film, "n_frames")  # noqa: B009
        assert (film.size, count) == ((160, 90), 20)
        total_ms = 0
        for i in range(count):
            film.seek(i)
            total_ms += film.info["duration"]
            assert np.abs(np.asarray(film.convert("RGB")).astype(int) - squares()[i]).max() < 12
    assert total_ms == 20 * 60


def test_an_mp4_has_every_picture(tmp_path: Path):
    write_film(tmp_path / "x.mp4", iter(squares()), 30.0)
    command = [str(ffmpeg.get_ffmpeg_exe()), "-i", str(tmp_path / "x.mp4"), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    read = subprocess.run(command, capture_output=True, check=True)
    frames = np.frombuffer(read.stdout, dtype=np.uint8).reshape(-1, 90, 160, 3)
    assert len(frames) == 20 and b"160x90" in read.stderr and b"30 fps" in read.stderr
    assert all(np.abs(a.astype(int) - b).mean() < 8 for a, b in zip(frames, squares(), strict=True))


def test_what_cannot_be_written_is_said_and_leaves_nothing(tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r"ends in \.gif or \.mp4"):
        write_film(tmp_path / "x.avi", squares(), 30.0)
    (tmp_path / "file").write_text("")
    for ending in ("gif", "mp4"):
        with pytest.raises(InvalidInputError, match="Cannot write the film"):
            write_film(tmp_path / "file" / f"x.{ending}", squares(), 30.0)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.fixture(scope="module")
def trace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("trace") / "trial.npz"
    main(["trial", "ur5_linear", "--set", "timing.timeout_s=0.5", "--trace", str(path), "--json"])
    return path


@pytest.mark.parametrize("ending", ["gif", "mp4"])
def test_a_trace_is_rendered(trace: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], ending: str):
    out = tmp_path / f"x.{ending}"
    assert main(["render", str(trace), "--out", str(out), "--width", "160", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["width"], told["height"], told["bytes"]) == (160, 90, out.stat().st_size)
    assert told["seconds"] == pytest.approx(0.5 + LAST_S, abs=0.1)


def test_what_cannot_be_rendered_is_refused(trace: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    with np.load(trace) as arrays:
        header, rows = json.loads(str(arrays["header"])), arrays["rows"]
    header["record"]["fingerprint"] = "0" * 16
    other = tmp_path / "other.npz"
    np.savez_compressed(other, header=np.array(json.dumps(header)), rows=rows)
    (tmp_path / "text.npz").write_text("no trace")
    out = str(tmp_path / "x.gif")
    for words, arguments in {
        "comes out otherwise than it was traced": [str(other), "--out", out],
        "is not a trace": [str(tmp_path / "text.npz"), "--out", out],
        "There is no trace file": [str(tmp_path / "none.npz"), "--out", out],
        "--out ends in .gif or .mp4": [str(trace), "--out", str(tmp_path / "x.webm")],
        "--width is from 160 to 1920": [str(trace), "--out", out, "--width", "9999"],
        "--speed is from": [str(trace), "--out", out, "--speed", "nan"],
    }.items():
        assert main(["render", *arguments]) == 2
        assert words in capsys.readouterr().err
    assert not Path(out).exists()


def test_every_moment_is_drawn_once(linear: tuple[SceneDescription, Snapshot]):
    takes = Takes(linear[0], moments_of(linear[1], 3))
    drawn = list(pictures(takes, load_scenario("ur5_linear"), shown(takes, 10.0, 1.0), 160, 90))
    assert len({id(picture) for picture in drawn}) < len(drawn) == 1 + round(LAST_S * 10)
