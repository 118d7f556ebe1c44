"""IK branches at every vertex of the chart's grid: from random postures first, then from neighbour to neighbour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import collision
from backend.kinematics.chain import move_bodies
from backend.kinematics.collision import BodyArrays, Margins, RobotArrays
from backend.kinematics.compiled import kernel
from backend.kinematics.inverse import SAME_BRANCH_RAD, descend, wrap_near
from backend.knowledge.reach_chart import fill_coordinates, fill_row
from backend.pose import Array

Branches = NDArray[np.float32]
"""(vertices, most, dof) rad; roll is zero."""
Counts = NDArray[np.uint8]
"""(vertices,)."""
Shape = tuple[int, int, int, int, int]
ALIKE_RAD = 0.3
"""A neighbour's posture this near to one of ours is taken for the same branch without trying."""


@kernel
def vertex(shape: Shape, a: int, b: int, c: int, d: int) -> int:
    """Flat index, without roll."""
    return ((a * shape[1] + b) * shape[2] + c) * shape[3] + d


@kernel
def turned(difference_rad: float) -> float:
    """Into [-pi, pi]."""
    return difference_rad - 2.0 * np.pi * np.round(difference_rad / (2.0 * np.pi))


@kernel
def known(branches: Branches, count: int, q: Array, tolerance_rad: float) -> bool:
    """Whether ``q`` is, up to full turns, within the tolerance of one of the first ``count`` branches."""
    for k in range(count):
        same = True
        for j in range(q.shape[0]):
            if abs(turned(branches[k, j] - q[j])) > tolerance_rad:
                same = False
                break
        if same:
            return True
    return False


@kernel
def add_branch(
    links: Array, limits: Array, middle: Array, target: Array, branches: Branches, count: int, q: Array, frames: Array
) -> int:
    """Descend from ``q`` and keep what is new; the new number of branches."""
    if count == branches.shape[0] or known(branches, count, q, ALIKE_RAD):
        return count
    if not (descend(links, target, q, frames) and wrap_near(q, middle, limits[0], limits[1])):
        return count
    if known(branches, count, q, SAME_BRANCH_RAD):
        return count
    branches[count, :] = q
    return count + 1


@kernel
def sow(
    links: Array,
    limits: Array,
    signs: tuple[float, float],
    grid: tuple[Shape, Array, Array],
    wanted: NDArray[np.bool_],
    postures: Array,
    branches: Branches,
    counts: Counts,
) -> None:
    """Descend from every posture to the vertex nearest to its tcp. ``signs``: of the first and of the last joint."""
    shape, origin, steps = grid
    dof = postures.shape[1]
    frames, x, target, q = np.empty((dof + 2, 12)), np.empty(5), np.empty(12), np.empty(dof)
    middle = 0.5 * (limits[0] + limits[1])
    at = np.empty(4, dtype=np.int64)
    for i in range(postures.shape[0]):
        move_bodies(links, postures[i], frames)
        azimuth = fill_coordinates(frames[dof + 1], x)
        q[:] = postures[i]
        q[0] -= signs[0] * azimuth
        q[dof - 1] -= signs[1] * x[4]
        inside = True
        for axis in range(4):
            at[axis] = int(np.round((x[axis] - origin[axis]) / steps[axis]))
            inside = inside and 0 <= at[axis] < shape[axis]
            x[axis] = origin[axis] + steps[axis] * at[axis]
        if not inside or not wanted[at[2], at[3]]:
            continue
        x[4] = 0.0
        fill_row(x, target)
        n = vertex(shape, at[0], at[1], at[2], at[3])
        counts[n] = add_branch(links, limits, middle, target, branches[n], counts[n], q, frames)


@kernel
def spread(
    links: Array,
    limits: Array,
    grid: tuple[Shape, Array, Array],
    wanted: NDArray[np.bool_],
    backwards: bool,
    branches: Branches,
    counts: Counts,
) -> int:
    """Carry every vertex's branches to its neighbours, in one walk through the grid; how many were new."""
    shape, origin, steps = grid
    dof = links.shape[0] - 1
    frames, x, target, q = np.empty((dof + 2, 12)), np.zeros(5), np.empty(12), np.empty(dof)
    middle = 0.5 * (limits[0] + limits[1])
    total = shape[0] * shape[1] * shape[2] * shape[3]
    strides = (shape[1] * shape[2] * shape[3], shape[2] * shape[3], shape[3], 1)
    fresh = 0
    for i in range(total):
        n = total - 1 - i if backwards else i
        at = (n // strides[0], n // strides[1] % shape[1], n // strides[2] % shape[2], n % shape[3])
        if not wanted[at[2], at[3]]:
            continue
        for axis in range(4):
            x[axis] = origin[axis] + steps[axis] * at[axis]
        fill_row(x, target)
        before = counts[n]
        for axis in range(4):
            for side in (-1, 1):
                if not 0 <= at[axis] + side < shape[axis]:
                    continue
                other = n + side * strides[axis]
                for k in range(counts[other]):
                    q[:] = branches[other, k]
                    counts[n] = add_branch(links, limits, middle, target, branches[n], counts[n], q, frames)
        fresh += counts[n] - before
    return fresh


@kernel
def any_free(
    robot: RobotArrays, bodies: BodyArrays, margins: Margins, branches: Branches, count: int, turn_rad: float
) -> bool:
    """Whether one of the branches, its last joint turned by ``turn_rad``, touches nothing."""
    q = np.empty(branches.shape[1])
    for k in range(count):
        q[:] = branches[k]
        q[-1] += turn_rad
        if collision.free(robot, bodies, margins, 0, q):
            return True
    return False


@kernel
def label(
    robot: RobotArrays,
    bodies: BodyArrays,
    margins: Margins,
    roll_step_rad: float,
    span: tuple[int, int],
    branches: Branches,
    counts: Counts,
    reachable: NDArray[np.bool_],
) -> None:
    """Fill ``reachable`` (vertices, rolls) for the vertices of ``span``; the roll step has the last joint's sign."""
    for n in range(span[0], span[1]):
        for k in range(reachable.shape[1]):
            turn = k * roll_step_rad
            reachable[n, k] = counts[n] > 0 and any_free(robot, bodies, margins, branches[n], counts[n], turn)
