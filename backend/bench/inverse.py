"""IK on random poses that the arm reaches."""

from __future__ import annotations

import math
import time

import numpy as np
from numpy.typing import NDArray

from backend.bench.figure import Figure
from backend.kinematics import load_kinematics

NEAR_M, NEAR_RAD = 1e-3, math.radians(0.5)


def figures(robot: str, poses: int, rng: np.random.Generator) -> list[Figure]:
    """Share solved, asked for all at once, and the median time of one, asked for one by one."""
    kinematics = load_kinematics(robot)
    kinematics.warm_up()
    home = np.array(kinematics.description.home_rad)
    qs = rng.uniform(kinematics.limits[0], kinematics.limits[1], size=(poses, kinematics.dof))
    Ts = kinematics.fk_many(qs)
    found, took_s = np.empty_like(qs), np.empty(poses)
    for i in range(poses):
        begun_s = time.perf_counter()
        solution, _ = kinematics.ik_many(Ts[i : i + 1], home)
        took_s[i] = time.perf_counter() - begun_s
        found[i] = solution[0]
    solved: NDArray[np.bool_] = np.isfinite(found[:, 0])
    reached = kinematics.fk_many(np.where(solved[:, None], found, home))
    off_m = np.linalg.norm(reached[:, :3, 3] - Ts[:, :3, 3], axis=1)
    cosine = 0.5 * (np.einsum("nij,nij->n", reached[:, :3, :3], Ts[:, :3, :3]) - 1.0)
    off_rad = np.arccos(np.clip(cosine, -1.0, 1.0))
    beyond_rad = np.maximum(kinematics.limits[0] - found, found - kinematics.limits[1]).max(axis=1)
    good = solved & (off_m <= NEAR_M) & (off_rad <= NEAR_RAD) & (beyond_rad <= 1e-9)
    share = 100.0 * float(good.mean())
    median_us = 1e6 * float(np.median(took_s))
    return [
        Figure("inverse kinematics", f"{robot}: solved to 1 mm and 0.5 degrees", share, "%", ">=", 99.9, poses),
        Figure("inverse kinematics", f"{robot}: median time", median_us, "us", "<=", 50.0, poses),
    ]
