"""Variety: of grasps much alike only the best is kept, so that the nearest of the kept ones can be near."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from backend.pose import Array

APART_M = 0.1
APART_RAD = 1.0
"""Two grasps are alike when shift / APART_M and turn / APART_RAD, as legs of a right angle, come to less than 1."""

Alike = NDArray[np.bool_]
"""(n, n) which grasps of a database are alike; each is like itself."""


def alike(Ts_object_grasp: Array) -> Alike:
    """Which of (n, 4, 4) grasps are alike."""
    turns, shifts_m = Ts_object_grasp[:, :3, :3], Ts_object_grasp[:, :3, 3]
    traces = np.einsum("iab,jab->ij", turns, turns)
    turned = np.arccos(np.clip(0.5 * (traces - 1.0), -1.0, 1.0)) / APART_RAD
    shifted = np.linalg.norm(shifts_m[:, None] - shifts_m[None], axis=2) / APART_M
    return np.hypot(turned, shifted) < 1.0


def varied(ranked: Sequence[int], keep: int, alike: Alike | None) -> tuple[list[int], frozenset[int]]:
    """The first ``keep`` of the ``ranked`` that are not like a better one, and those that were passed over for it.

    Where there are not as many, the best of those passed over are kept too. Without ``alike``: simply the first.
    """
    if alike is None:
        return list(ranked[:keep]), frozenset()
    kept, passed = list[int](), list[int]()
    covered = np.zeros(len(alike), dtype=np.bool_)
    for i in ranked:
        if len(kept) == keep:
            break
        if covered[i]:
            passed.append(i)
        else:
            kept.append(i)
            covered |= alike[i]
    filled = passed[: keep - len(kept)]
    if filled:
        among = {*kept, *filled}
        kept = [i for i in ranked if i in among]
    return kept, frozenset(passed[len(filled) :])
