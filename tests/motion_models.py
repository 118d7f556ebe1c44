"""Motion-aware models with drawn weights, for tests of what uses them."""

from pathlib import Path

import numpy as np
import pytest

from backend.knowledge import motion_aware as knowledge
from backend.knowledge.motion_aware import Floats, Layer, MotionAwareModel, save_motion_aware
from backend.knowledge.motion_features import FEATURES
from backend.pose import Array, Pose

HIDDEN = 32


def drawn_model(robot: str = "mico", object: str = "cube", seed: int = 0, hidden: int = HIDDEN) -> MotionAwareModel:
    """A network whose answers vary with grasp, speed and direction."""
    rng = np.random.default_rng(seed)

    def layer(out: int, into: int) -> Layer:
        weight: Floats = (rng.normal(size=(out, into)) / np.sqrt(into)).astype(np.float16).astype(np.float32)
        return weight, rng.normal(0.0, 0.1, out).astype(np.float32)

    center = rng.normal(0.0, 0.1, FEATURES).astype(np.float32)
    scale = rng.uniform(0.05, 1.0, FEATURES).astype(np.float32)
    scale[-3] = 0.01
    layers = layer(hidden, FEATURES), layer(hidden, hidden), layer(1, hidden)
    return MotionAwareModel(robot, object, 0.05, (0.005, 0.05), center, scale, layers, {"seed": seed})


def plant_models(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """Let ``load_motion_aware`` find a drawn model of every hand and object it is asked for."""

    def elsewhere(robot: str, object: str) -> Path:
        path = folder / robot / f"{object}.npz"
        return path if path.is_file() else save_motion_aware(drawn_model(robot, object), path)

    monkeypatch.setattr(knowledge, "motion_aware_file", elsewhere)


def random_grasps(count: int, seed: int = 0) -> Array:
    """(count, 4, 4) hands in any posture around an object."""
    rng = np.random.default_rng(seed)
    return np.array([Pose.from_xyz_rpy(rng.normal(0, 0.05, 3), rng.uniform(-3, 3, 3)).matrix for _ in range(count)])
