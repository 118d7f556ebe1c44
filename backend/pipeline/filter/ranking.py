"""What every filter is given beside the candidates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import Kinematics
from backend.pipeline.filter.known import Known
from backend.pipeline.values import PlanarMotion
from backend.pose import Array
from backend.sim.planning_scene import PlanningScene

PUT_OFF = "it was refused a moment ago"


@dataclass(frozen=True, eq=False)
class RankContext:
    """The arm, its surroundings and chance."""

    kinematics: Kinematics
    scene: PlanningScene
    q: Array
    """(dof,) rad, where the arm will be when the result takes effect."""
    held: int | None
    """Index of the grasp the arm is moving to."""
    put_off: frozenset[int]
    """Indices of grasps that were refused a moment ago, by a room or in rehearsal."""
    lift_m: float
    rng: np.random.Generator
    known: Known
    motion: PlanarMotion | None = None
    """What the object is predicted to do during the approach."""


def best_first(score: Array, among: NDArray[np.bool_], held: int | None) -> list[int]:
    """Those ``among`` (n,) the candidates, by ``score`` (n,); the grasp the arm is moving to before all others."""
    left = np.flatnonzero(among)
    ranked = left[np.argsort(-score[left], kind="stable")].tolist()
    if held is not None and among[held]:
        ranked.remove(held)
        ranked.insert(0, held)
    return ranked
