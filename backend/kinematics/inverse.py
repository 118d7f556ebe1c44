"""Inverse kinematics: compiled Levenberg-Marquardt with error-scaled damping and restarts from a fixed table.

Damping after Sugihara, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method",
IEEE T-RO 27(5), 2011. Poses are rows of 12, see ``chain``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.chain import fill_jacobian, move_bodies
from backend.kinematics.compiled import kernel
from backend.pose import Array

POSITION_TOLERANCE_M = 1e-6
ROTATION_TOLERANCE_RAD = 1e-5
GOOD_POSITION_M = 5e-5
GOOD_ROTATION_RAD = 5e-4
"""Near a singularity descents crawl; this is still taken as arrived."""
ROTATION_WEIGHT_M = 0.1
"""Metres that one radian counts for."""
MAX_STEP_RAD = 0.6
MAX_ITERATIONS = 40
SAME_BRANCH_RAD = 0.05
"""Solutions closer than this in every joint are one branch."""


@kernel
def pose_error(target: Array, tcp: Array, error: Array) -> float:
    """Fill ``error`` (6,): metres, then weighted rotation vector; return its squared length."""
    for k in range(3):
        error[k] = target[9 + k] - tcp[9 + k]
    d = np.empty(9)
    for i in range(3):
        for j in range(3):
            d[3 * i + j] = (
                target[3 * i] * tcp[3 * j] + target[3 * i + 1] * tcp[3 * j + 1] + target[3 * i + 2] * tcp[3 * j + 2]
            )
    x, y, z = d[7] - d[5], d[2] - d[6], d[3] - d[1]
    sine = np.sqrt(x * x + y * y + z * z)
    angle = np.arctan2(sine, d[0] + d[4] + d[8] - 1.0)
    scale = ROTATION_WEIGHT_M * (angle / sine if sine > 1e-9 else 0.5)
    error[3], error[4], error[5] = scale * x, scale * y, scale * z
    if sine <= 1e-9 and angle > 1.0:
        error[3] = ROTATION_WEIGHT_M * angle
    total = 0.0
    for k in range(6):
        total += error[k] * error[k]
    return total


@kernel
def solve_damped(jacobian: Array, error: Array, damping: float, H: Array, step: Array) -> None:
    """``step = (J^T J + damping I)^-1 J^T error`` by Cholesky; overwrites ``H`` (dof, dof)."""
    n = step.shape[0]
    for i in range(n):
        step[i] = 0.0
        for k in range(6):
            step[i] += jacobian[k, i] * error[k]
        for j in range(i + 1):
            h = damping if i == j else 0.0
            for k in range(6):
                h += jacobian[k, i] * jacobian[k, j]
            H[i, j] = h
    for j in range(n):
        for i in range(j, n):
            h = H[i, j]
            for k in range(j):
                h -= H[i, k] * H[j, k]
            H[i, j] = np.sqrt(h) if i == j else h / H[j, j]
    for i in range(n):
        for k in range(i):
            step[i] -= H[i, k] * step[k]
        step[i] /= H[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            step[i] -= H[k, i] * step[k]
        step[i] /= H[i, i]


@kernel
def descend(links: Array, target: Array, q: Array, frames: Array) -> bool:
    """Move ``q`` in place until the tcp is at ``target``; False when it does not arrive. No limits."""
    dof = q.shape[0]
    error, step = np.empty(6), np.empty(dof)
    jacobian, H = np.empty((6, dof)), np.empty((dof, dof))
    checkpoint, total, linear = np.inf, np.inf, np.inf
    for iteration in range(MAX_ITERATIONS):
        move_bodies(links, q, frames)
        total = pose_error(target, frames[dof + 1], error)
        linear = error[0] ** 2 + error[1] ** 2 + error[2] ** 2
        if linear < POSITION_TOLERANCE_M**2 and total - linear < (ROTATION_WEIGHT_M * ROTATION_TOLERANCE_RAD) ** 2:
            return True
        if iteration % 6 == 5:
            if total > 0.7 * checkpoint:
                break
            checkpoint = total
        fill_jacobian(frames, jacobian)
        for i in range(dof):
            for k in range(3, 6):
                jacobian[k, i] *= ROTATION_WEIGHT_M
        solve_damped(jacobian, error, 0.5 * total + 1e-6, H, step)
        largest = np.max(np.abs(step))
        factor = min(1.0, MAX_STEP_RAD / largest) if largest > 0.0 else 1.0
        for i in range(dof):
            q[i] += factor * step[i]
    return linear < GOOD_POSITION_M**2 and total - linear < (ROTATION_WEIGHT_M * GOOD_ROTATION_RAD) ** 2


@kernel
def wrap_near(q: Array, near: Array, lower: Array, upper: Array) -> bool:
    """Shift joints by full turns to their values nearest to ``near`` within limits; False when none is."""
    for i in range(q.shape[0]):
        value = q[i] + 2.0 * np.pi * np.round((near[i] - q[i]) / (2.0 * np.pi))
        if value > upper[i]:
            value -= 2.0 * np.pi * np.ceil((value - upper[i]) / (2.0 * np.pi))
        elif value < lower[i]:
            value += 2.0 * np.pi * np.ceil((lower[i] - value) / (2.0 * np.pi))
        if value > upper[i] or value < lower[i]:
            return False
        q[i] = value
    return True


@kernel
def solve_near(links: Array, lower: Array, upper: Array, target: Array, near: Array, q: Array) -> bool:
    """One descent from ``near`` into ``q``, wrapped into limits next to ``near``."""
    frames = np.empty((near.shape[0] + 2, 12))
    q[:] = near
    return descend(links, target, q, frames) and wrap_near(q, near, lower, upper)


@kernel
def solve_each(links: Array, limits: Array, targets: Array, nears: Array) -> tuple[Array, NDArray[np.bool_]]:
    """One descent per target (n, 12) from its own row of ``nears`` (n, dof): joints, NaN where it failed."""
    n = targets.shape[0]
    out, ok = np.empty(nears.shape), np.zeros(n, dtype=np.bool_)
    for i in range(n):
        ok[i] = solve_near(links, limits[0], limits[1], targets[i], nears[i], out[i])
        if not ok[i]:
            out[i] = np.nan
    return out, ok


@kernel
def rate_seeds(target: Array, seed_rows: Array, yaw_sign: float, cost: Array) -> None:
    """Fill ``cost`` (n,) with how far each seed's tcp is from ``target``, squared.

    A first joint that turns about the world's z (``yaw_sign`` +-1) brings seeds to the target's azimuth.
    """
    reach = np.sqrt(target[9] ** 2 + target[10] ** 2)
    for k in range(seed_rows.shape[0]):
        row = seed_rows[k]
        c, s = 1.0, 0.0
        linear = (target[9] - row[9]) ** 2 + (target[10] - row[10]) ** 2
        if yaw_sign != 0.0:
            seed_reach = np.sqrt(row[9] ** 2 + row[10] ** 2)
            both = max(reach * seed_reach, 1e-12)
            c = (target[9] * row[9] + target[10] * row[10]) / both
            s = (target[10] * row[9] - target[9] * row[10]) / both
            linear = (reach - seed_reach) ** 2
        trace = 0.0
        for j in range(3):
            trace += target[j] * (c * row[j] - s * row[3 + j])
            trace += target[3 + j] * (s * row[j] + c * row[3 + j])
            trace += target[6 + j] * row[6 + j]
        linear += (target[11] - row[11]) ** 2
        cost[k] = linear + ROTATION_WEIGHT_M**2 * (3.0 - trace)


@kernel
def take_best(target: Array, seeds: Array, seed_rows: Array, yaw_sign: float, cost: Array, q: Array) -> None:
    """Put the seed of least ``cost`` into ``q``, its first joint turned to the target; it is not taken again."""
    best = int(np.argmin(cost))
    cost[best] = np.inf
    row = seed_rows[best]
    q[:] = seeds[best]
    q[0] += yaw_sign * (np.arctan2(target[10], target[9]) - np.arctan2(row[10], row[9]))


@kernel
def solve_many(
    links: Array,
    limits: Array,
    targets: Array,
    near: Array,
    seeds: Array,
    seed_rows: Array,
    yaw_sign: float,
    restarts: int,
) -> tuple[Array, NDArray[np.bool_]]:
    """IK of ``targets`` (n, 12) from ``near``, then from the nearest seeds: (n, dof) joints, (n,) success."""
    n, dof = targets.shape[0], near.shape[0]
    lower, upper = limits[0], limits[1]
    out, ok = np.empty((n, dof)), np.zeros(n, dtype=np.bool_)
    frames, cost = np.empty((dof + 2, 12)), np.empty(seeds.shape[0])
    for i in range(n):
        ok[i] = solve_near(links, lower, upper, targets[i], near, out[i])
        if ok[i] or restarts == 0:
            continue
        rate_seeds(targets[i], seed_rows, yaw_sign, cost)
        for _ in range(min(restarts, seeds.shape[0])):
            take_best(targets[i], seeds, seed_rows, yaw_sign, cost, out[i])
            if descend(links, targets[i], out[i], frames) and wrap_near(out[i], near, lower, upper):
                ok[i] = True
                break
        if not ok[i]:
            out[i] = np.nan
    return out, ok


@kernel
def solve_branches(
    links: Array,
    limits: Array,
    target: Array,
    near: Array,
    seeds: Array,
    seed_rows: Array,
    yaw_sign: float,
    tries: int,
) -> Array:
    """Distinct solutions (k, dof) for one target, each wrapped next to ``near``, nearest first."""
    dof = near.shape[0]
    lower, upper = limits[0], limits[1]
    frames, cost = np.empty((dof + 2, 12)), np.empty(seeds.shape[0])
    rate_seeds(target, seed_rows, yaw_sign, cost)
    tries = min(tries, seeds.shape[0])
    found = np.empty((tries + 1, dof))
    count = 0
    for attempt in range(tries + 1):
        q = found[count]
        if attempt == 0:
            q[:] = near
        else:
            take_best(target, seeds, seed_rows, yaw_sign, cost, q)
        if not (descend(links, target, q, frames) and wrap_near(q, near, lower, upper)):
            continue
        new = True
        for k in range(count):
            if np.max(np.abs(found[k] - q)) < SAME_BRANCH_RAD:
                new = False
                break
        if new:
            count += 1
    distance = np.empty(count)
    for k in range(count):
        distance[k] = np.sum((found[k] - near) ** 2)
    return found[:count][np.argsort(distance, kind="mergesort")]


@kernel
def follow_rows(links: Array, limits: Array, targets: Array, start: Array, max_step_rad: float) -> tuple[Array, int]:
    """IK along dense ``targets`` (m, 12), each from the one before: (m, dof) and how many were reached."""
    m, dof = targets.shape[0], start.shape[0]
    out, frames = np.empty((m, dof)), np.empty((dof + 2, 12))
    previous = start
    for i in range(m):
        out[i] = previous
        if not descend(links, targets[i], out[i], frames):
            return out, i
        for j in range(dof):
            if out[i, j] < limits[0, j] or out[i, j] > limits[1, j] or abs(out[i, j] - previous[j]) > max_step_rad:
                return out, i
        previous = out[i]
    return out, m
