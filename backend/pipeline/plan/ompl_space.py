"""OMPL's side of joint space: the box that is sampled, which motions are valid, where random numbers start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import util as ou

from backend.pose import Array


def start_random_numbers(rng_seed: int) -> None:
    """Make whatever OMPL draws from now on depend on ``rng_seed`` only.

    OMPL draws the seed of every generator from one global sequence. That sequence is started anew here, so this
    must come before anything that owns a generator is made. OMPL logs an error about it, which is why its log is
    switched off.
    """
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(1 + rng_seed % (2**31 - 1))


def space_information(box: Array, is_free: Callable[[Array], bool], motion_free: Callable[[Array, Array], bool]) -> Any:
    """An ``ob.SpaceInformation`` of joint space within ``box`` (2, dof) that asks these about postures and edges.

    It is not set up yet: a planner may want samplers of its own in it.
    """
    dof = box.shape[1]
    bounds = ob.RealVectorBounds(dof)
    for i in range(dof):
        bounds.setLow(i, float(box[0, i]))
        bounds.setHigh(i, float(box[1, i]))
    space = ob.RealVectorStateSpace(dof)
    space.setBounds(bounds)
    info = ob.SpaceInformation(space)

    def is_valid(state: Any) -> bool:
        return is_free(np.array(state[0:dof]))

    class Motions(ob.MotionValidator):
        def checkMotion(self, a: Any, b: Any) -> bool:
            return motion_free(np.array(a[0:dof]), np.array(b[0:dof]))

    info.setStateValidityChecker(is_valid)
    info.setMotionValidator(Motions(info))
    return info
