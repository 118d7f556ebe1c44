"""A rig whose outcomes follow a rule that a test plants, in place of physics; importable by other processes."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from backend.build.motion_data import AttemptSettings, Source
from backend.pose import Array, Pose


@dataclass(frozen=True)
class Planted:
    held: bool
    why: str


class PlantedRig:
    """Holds near the middle, and the better the more the object comes towards the hand; never beyond 4 cm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def attempt(
        self,
        T_object_grasp: Pose,
        T_believed_object: Pose | None = None,
        velocity_mps: Array | None = None,
    ) -> Planted:
        velocity = np.zeros(2) if velocity_mps is None else velocity_mps
        seen = (T_believed_object or Pose.identity()).inverse() @ T_object_grasp
        off_m = float(np.linalg.norm(seen.xyz_m - [0.0, 0.0, 0.05]))
        towards_mps = -float(T_object_grasp.rotation[:2, 2] @ velocity)
        held = off_m < min(0.02 + 0.6 * towards_mps, 0.04)
        return Planted(held, "" if held else "too far off")


def make_planted_rig(robot: str, object: str) -> PlantedRig:
    return PlantedRig()


def planted_source(seed: int = 0, grasps: int = 30, settings: AttemptSettings | None = None) -> Source:
    """Side grasps from all around at a point 5 cm above the object's origin."""
    level = Pose.from_xyz_rpy((0.0, 0.0, 0.05), (0.0, np.pi / 2, 0.0))
    Ts = [(Pose.from_xyz_yaw((0.0, 0.0, 0.0), a) @ level).matrix for a in np.linspace(0.0, 2 * np.pi, grasps, False)]
    return Source("mico", "cube", np.array(Ts), seed, settings or AttemptSettings(), make_planted_rig)
