"""The goals of picked grasps that are planned to at once."""

import numpy as np

from backend.pipeline.values import Candidate
from backend.pose import Array

GRASPS_AT_FIRST = 4
"""So many at least while the arm is not on its way to one of them: the nearest goal that a straight edge reaches may be
of another than the nearest grasp."""


def goals_at_once(
    picked: list[Candidate], held: Candidate | None, at_once: int, q: Array
) -> tuple[list[Candidate], list[tuple[Candidate, Array]]]:
    """The first of the ``picked`` grasps, and each of their goals (dof,) with its grasp, preferred ones first.

    ``held``: the grasp the arm is moving to; while it is among the picked, those ``at_once`` are taken in their order,
    otherwise the goals that are nearest to ``q`` come first.
    """
    underway = held is not None and any(candidate.index == held.index for candidate in picked)
    asked = picked[: at_once if underway else max(at_once, GRASPS_AT_FIRST)]
    choices = [(candidate, goal.q_pregrasp) for candidate in asked for goal in candidate.goals]
    if not underway:
        choices.sort(key=lambda choice: float(np.abs(choice[1] - q).max()))
    return asked, choices
