"""Attempts: how they are drawn, kept and gone on with, and how they are parted."""

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from backend.build import motion_data
from backend.build.attempts import COLUMNS, Attempts
from backend.build.digests import digest_of, urdf_digest
from backend.build.motion_data import CHUNK, AttemptSettings, GraspChoice, Source, chunk_file, draw, gather
from backend.build.motion_split import SplitSettings, split
from backend.errors import InvalidInputError
from backend.pose import Pose, rotation_angle_rad
from backend.robots.models import load_model
from tests.planted_rig import PlantedRig, planted_source

COUNT = 2 * CHUNK + 30
Quiet = Callable[[str], None]


def quiet(text: str) -> None:
    pass


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    def folder() -> Path:
        return tmp_path / "cache"

    monkeypatch.setattr(motion_data, "cache_folder", folder)
    return folder()


def same(a: Attempts, b: Attempts) -> bool:
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in COLUMNS)


def test_a_draw_depends_on_seed_and_index_alone():
    source = planted_source(seed=3)
    alone = draw(source, 17)
    among = [draw(source, index) for index in range(30)][17]
    np.testing.assert_array_equal(alone.T_object_grasp.matrix, among.T_object_grasp.matrix)
    np.testing.assert_array_equal(alone.velocity_mps, among.velocity_mps)
    np.testing.assert_array_equal(alone.misplaced, among.misplaced)
    assert not np.array_equal(draw(planted_source(seed=4), 17).velocity_mps, alone.velocity_mps)


def test_draws_keep_to_their_settings():
    source = planted_source()
    s = source.settings
    cases = [draw(source, index) for index in range(3000)]
    speeds = np.array([np.linalg.norm(case.velocity_mps) for case in cases])
    assert s.speeds_mps[0] <= speeds.min() and speeds.max() <= s.speeds_mps[1]
    assert speeds.mean() == pytest.approx(np.mean(s.speeds_mps), abs=0.001)
    units = np.array([case.velocity_mps for case in cases]) / speeds[:, None]
    assert np.linalg.norm(units.mean(axis=0)) < 0.05
    misplaced = np.abs([case.misplaced for case in cases]).max(axis=0)
    limits = (s.misplaced_m, s.misplaced_m, s.misplaced_rad)
    assert (misplaced <= limits).all() and (misplaced > 0.98 * np.array(limits)).all()
    as_they_are = [case for case in cases if case.variant == 0]
    assert len(as_they_are) / len(cases) == pytest.approx(0.40, abs=0.03)
    for case in as_they_are:
        np.testing.assert_array_equal(case.T_object_grasp.matrix, source.Ts_object_grasp[case.grasp])
    assert {case.grasp for case in cases} == set(range(len(source.Ts_object_grasp)))


def test_every_perturbed_grasp_is_near_its_own_and_has_its_own_number():
    source = planted_source(settings=AttemptSettings(choices=(GraspChoice(1.0, 0.004, 0.05),)))
    cases = [draw(source, index) for index in range(2000)]
    off = [Pose(source.Ts_object_grasp[case.grasp]).inverse() @ case.T_object_grasp for case in cases]
    np.testing.assert_allclose(np.std([T.xyz_m for T in off], axis=0), 0.004, rtol=0.1)
    turned = [rotation_angle_rad(np.eye(3), T.rotation) for T in off]
    assert np.sqrt(np.mean(np.square(turned))) == pytest.approx(0.05 * np.sqrt(3.0), rel=0.1)
    variants = [case.variant for case in cases]
    assert min(variants) > 0 and len(set(variants)) == len(variants)


def test_the_true_object_lies_where_the_draw_says():
    case = replace(draw(planted_source(), 0), misplaced=np.array([0.003, -0.002, 0.1]))
    expected = Pose.from_xyz_yaw((0.003, -0.002, 0.0), 0.1)
    np.testing.assert_allclose(case.T_believed_object.matrix, expected.matrix)


def test_any_split_over_workers_gives_the_same_attempts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    alone = gather(planted_source(), COUNT, 1, quiet)
    monkeypatch.setattr(motion_data, "cache_folder", lambda: tmp_path / "other")
    assert same(gather(planted_source(), COUNT, 2, quiet), alone)
    assert alone.index.tolist() == list(range(COUNT))
    assert 0.1 < alone.held.mean() < 0.9 and set(alone.why.tolist()) == {"held", "too far off"}


def test_a_killed_gathering_goes_on_where_it_was(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    source = planted_source()

    def killed(text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gather(source, COUNT, 1, killed)
    assert [path.name for path in source.folder.iterdir()] == [f"000000-{CHUNK:06d}.npz"]
    tried: list[int] = []
    attempt = PlantedRig.attempt

    def counted(self: PlantedRig, *arguments: object) -> object:
        tried.append(1)
        return attempt(self, *arguments)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(PlantedRig, "attempt", counted)
    told: list[str] = []
    went_on = gather(source, COUNT, 1, told.append)
    assert len(tried) == COUNT - CHUNK
    assert told[0] == f"{CHUNK} of {COUNT} attempts are there already" and "min to go" in told[-1]
    monkeypatch.setattr(motion_data, "cache_folder", lambda: tmp_path / "other")
    assert same(went_on, gather(source, COUNT, 1, quiet))


def test_what_is_there_is_read_and_what_is_broken_is_made_again():
    source = planted_source()
    first = gather(source, COUNT, 1, quiet)
    path = chunk_file(source.folder, (CHUNK, 2 * CHUNK))
    path.write_bytes(path.read_bytes()[:1000])
    assert same(gather(source, COUNT, 1, quiet), first)
    assert same(gather(source, CHUNK, 1, quiet), first.take(np.arange(CHUNK)))


@pytest.mark.parametrize(
    "other",
    [
        planted_source(seed=1),
        planted_source(grasps=29),
        planted_source(settings=AttemptSettings(misplaced_m=0.0)),
        replace(planted_source(), object="sugar_box"),
        replace(planted_source(), robot="ur5_robotiq"),
        replace(planted_source(), make_rig=motion_data.make_rig),
    ],
)
def test_attempts_of_anything_else_are_kept_elsewhere(other: Source):
    assert other.digest() != planted_source().digest() == planted_source().digest()


def test_code_counts_and_its_comments_do_not(tmp_path: Path):
    def digest(text: str) -> str:
        (tmp_path / "one.py").write_text(text)
        return digest_of([tmp_path / "one.py"])

    plain = digest("def f(x):\n    return x + 1\n")
    assert digest('"""Room."""\n\ndef f(x):  # why\n    """What."""\n    return x  +  1\n') == plain
    assert digest("def f(x):\n    return x + 2\n") != plain


def test_no_attempts_or_no_grasps_are_refused():
    with pytest.raises(InvalidInputError, match="got 30 and 0"):
        gather(planted_source(), 0, 1, quiet)
    with pytest.raises(InvalidInputError, match="got 0 and 10"):
        gather(replace(planted_source(), Ts_object_grasp=np.zeros((0, 4, 4))), 10, 1, quiet)


def test_parts_are_disjoint_whole_and_do_not_share_held_out_grasps():
    grasp = np.random.default_rng(0).integers(0, 100, 5000)
    parts = split(grasp, 1, SplitSettings())
    rows = [parts.training, parts.validation, parts.trials, parts.grasps]
    assert np.array_equal(np.sort(np.concatenate(rows)), np.arange(5000))
    away = set(grasp[parts.grasps].tolist())
    assert len(away) == 10
    assert not away & set(grasp[np.concatenate(rows[:3])].tolist())
    assert set(grasp[parts.trials].tolist()) <= set(grasp[parts.training].tolist())
    assert len(parts.trials) == pytest.approx(450, abs=10) and len(parts.validation) == pytest.approx(450, abs=10)
    again = split(grasp, 1, SplitSettings())
    assert np.array_equal(again.training, parts.training)
    assert set(grasp[split(grasp, 2).grasps].tolist()) != away


def test_too_few_attempts_are_refused():
    with pytest.raises(InvalidInputError, match="3 attempts at 3 grasps are too few"):
        split(np.arange(3), 0)


def test_a_digest_of_a_hand_is_of_what_its_files_hold(tmp_path: Path):
    hand = load_model("mico").hand_urdf
    for name in ("here", "there"):
        shutil.copytree(hand.parent, tmp_path / name)
    here, there = (tmp_path / name / hand.name for name in ("here", "there"))
    assert urdf_digest(here) == urdf_digest(there) == urdf_digest(hand)
    mesh = there.parent / str(re.findall(r'filename="([^"]+)"', there.read_text())[0])
    mesh.write_text(mesh.read_text() + "\n# another\n")
    assert urdf_digest(there) != urdf_digest(here)
