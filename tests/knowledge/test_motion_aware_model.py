"""The motion-aware model as it is used and kept: what it is shown, slow objects, files, the models that come along."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from backend.errors import InvalidInputError, MissingResourceError, NotFoundError
from backend.knowledge import motion_aware as knowledge
from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import (
    load_motion_aware,
    motion_aware_file,
    read_motion_aware,
    save_motion_aware,
)
from backend.knowledge.motion_features import FEATURES, grasp_features, motion_features
from backend.knowledge.pairs import forget
from backend.objects import OBJECTS
from backend.pose import Pose
from backend.robots import ROBOTS
from tests.motion_models import drawn_model, random_grasps

PAIRS = [(robot, name) for robot in sorted(ROBOTS) for name in sorted(OBJECTS)]


def test_features_hold_grasp_pregrasp_and_motion():
    T = Pose.from_xyz_rpy((0.1, -0.2, 0.3), (0.4, 0.5, 0.6))
    pregrasp = T @ Pose.of((0.0, 0.0, -0.075))
    row = grasp_features(T.matrix[None], 0.075)[0]
    expected = [*T.xyz_m, *T.rotation[:, 0], *T.rotation[:, 1], *T.rotation[:, 2], *pregrasp.xyz_m]
    np.testing.assert_allclose(row, expected)
    motions = motion_features(np.array([0.03, 0.04]), np.array([np.pi - 1e-9, -np.pi + 1e-9]))
    np.testing.assert_allclose(motions, [[0.03, 0.0, -1.0], [0.04, 0.0, -1.0]], atol=1e-8)


def test_a_slow_objects_direction_does_not_count_and_a_full_turn_is_none():
    prepared = drawn_model().over(random_grasps(40))
    rest = prepared.quality(0.004, 1.0)
    np.testing.assert_array_equal(rest, prepared.quality(0.0, -2.0))
    turns = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    everywhere = np.mean([prepared.quality(0.005, turn) for turn in turns], axis=0)
    np.testing.assert_allclose(rest, everywhere, atol=1e-3)
    np.testing.assert_allclose(prepared.quality(0.03, np.pi), prepared.quality(0.03, -np.pi), atol=1e-6)
    assert np.abs(prepared.quality(0.03, 0.0) - prepared.quality(0.03, np.pi)).max() > 0.01
    np.testing.assert_array_equal(prepared.quality(0.05, 1.0), prepared.quality(0.5, 1.0))


def test_a_model_survives_the_file_and_stays_small(tmp_path: Path):
    model = drawn_model(hidden=512)
    path = save_motion_aware(model, tmp_path / "deep" / "cube.npz")
    assert path.stat().st_size * 14 <= 12e6
    again = read_motion_aware(path, "mico", "cube")
    Ts = random_grasps(50)
    np.testing.assert_array_equal(again.quality(Ts, 0.03, 0.5), model.quality(Ts, 0.03, 0.5))
    assert (again.speeds_mps, again.backoff_m, again.facts["seed"]) == (model.speeds_mps, model.backoff_m, 0)


@pytest.mark.parametrize("robot_object", [("mico", "power_drill"), ("ur5_robotiq", "cube")])
def test_a_model_that_is_not_built_names_its_command(
    robot_object: tuple[str, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    robot, name = robot_object

    def elsewhere(robot: str, object: str) -> Path:
        return tmp_path / robot / f"{object}.npz"

    monkeypatch.setattr(knowledge, "motion_aware_file", elsewhere)
    command = f"python -m backend build motion-aware --robot {robot} --object {name}"
    with pytest.raises(MissingResourceError, match=command):
        load_motion_aware(robot, name)


def test_unknown_names_are_refused():
    with pytest.raises(NotFoundError, match="no robot named 'ur5'"):
        load_motion_aware("ur5", "cube")
    with pytest.raises(NotFoundError, match="no object named 'cub'"):
        load_motion_aware("mico", "cub")
    assert motion_aware_file("mico", "cube").parts[-4:] == ("assets", "motion_aware", "mico", "cube.npz")


def test_the_model_of_an_own_object_lies_with_it_and_goes_with_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    path = save_motion_aware(drawn_model("mico", "thing"))
    assert path == motion_aware_file("mico", "thing") and tmp_path in path.parents
    assert tmp_path not in motion_aware_file("mico", "cube").parents
    forget("thing")
    assert not path.exists()


def test_broken_and_foreign_files_are_refused(tmp_path: Path):
    path = save_motion_aware(drawn_model(), tmp_path / "cube.npz")
    whole = path.read_bytes()
    with pytest.raises(InvalidInputError, match=r"model of mug for mico \(it belongs to mico and cube"):
        read_motion_aware(path, "mico", "mug")
    for content in (whole[: len(whole) // 2], b"", b"nonsense"):
        path.write_bytes(content)
        with pytest.raises(InvalidInputError, match="Make it with: python -m backend build motion-aware --robot mico"):
            read_motion_aware(path, "mico", "cube")
    model = drawn_model()
    nan = model.layers[0][0].copy()
    nan[3, 4] = np.nan
    short = (model.layers[0][0][:-1], model.layers[0][1])
    for layers, words in (
        (((nan, model.layers[0][1]), *model.layers[1:]), "not finite"),
        ((short, *model.layers[1:]), "expected"),
    ):
        save_motion_aware(replace(model, layers=layers), path)
        with pytest.raises(InvalidInputError, match=words):
            read_motion_aware(path, "mico", "cube")
    assert FEATURES == len(model.center)


@pytest.mark.parametrize(("robot", "name"), PAIRS)
def test_every_pair_has_a_small_model_that_tells_grasps_apart(robot: str, name: str):
    model = load_motion_aware(robot, name)
    assert motion_aware_file(robot, name).stat().st_size * len(PAIRS) <= 12e6
    quality = model.quality(load_grasps(robot, name).Ts_object_grasp, 0.03, 0.5)
    assert quality.mean() > 0.5 and quality.std() > 0.0


@pytest.mark.parametrize("part", ["trials", "grasps"])
def test_together_the_models_know_more_than_the_base_rates(part: str):
    """Each has been measured on few attempts; what they know shows over all of them."""
    measured = [load_motion_aware(*pair).facts["measured"][part] for pair in PAIRS]
    n, base, brier, accuracy = (
        np.array([row[name] for row in measured]) for name in ("n", "base_rate", "brier", "accuracy")
    )
    assert n.sum() > 500
    assert n @ brier < n @ (base * (1.0 - base))
    assert n @ accuracy > n @ np.maximum(base, 1.0 - base)
