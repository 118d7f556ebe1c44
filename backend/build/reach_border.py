"""Where between two vertices reachability ends, and the distance to it everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.build.reach_branches import Branches, Counts, Shape, add_branch, any_free
from backend.kinematics.collision import BodyArrays, Margins, RobotArrays
from backend.kinematics.compiled import kernel
from backend.knowledge.reach_chart import fill_row, fill_steps
from backend.pose import Array

NONE = 255
"""No border between two vertices."""
Scene = tuple[RobotArrays, BodyArrays, Margins, Array]
"""The robot, what is around it, margins, and joint limits (2, dof)."""
Grid = tuple[Shape, Array, Array]
"""Shape, origin (5,) and steps (5,)."""
Found = tuple[Branches, Counts, NDArray[np.bool_]]
"""Branches, how many, and (vertices, rolls) which of them reach."""
Shares = NDArray[np.uint8]
"""(vertices, rolls, 5) how far along the edge to the next vertex the border lies, in 1 / ``2**(halvings + 1)``."""


@kernel
def place_of(shape: Shape, n: int) -> tuple[int, int, int, int]:
    """Indices along rho, z, u, v of a flat one."""
    row = n // shape[3]
    return row // shape[2] // shape[1], row // shape[2] % shape[1], row % shape[2], n % shape[3]


@kernel
def strides_of(shape: Shape) -> tuple[int, int, int, int]:
    """Flat steps along rho, z, u, v."""
    return shape[1] * shape[2] * shape[3], shape[2] * shape[3], shape[3], 1


@kernel
def find_roll_borders(
    scene: Scene, roll_step: float, halvings: int, span: tuple[int, int], found: Found, shares: Shares
) -> None:
    """Halve every edge along roll between a reachable and an unreachable vertex: the last joint turns, no more."""
    robot, bodies, margins, _ = scene
    branches, counts, reachable = found
    rolls, parts = reachable.shape[1], 2**halvings
    for n in range(span[0], span[1]):
        for k in range(rolls):
            here = reachable[n, k]
            if here == reachable[n, (k + 1) % rolls]:
                continue
            low, high = 0, parts
            while high - low > 1:
                half = (low + high) // 2
                turn = roll_step * (k + half / parts)
                if any_free(robot, bodies, margins, branches[n], counts[n], turn) == here:
                    low = half
                else:
                    high = half
            shares[n, k, 4] = low + high


@kernel
def branches_between(
    scene: Scene, grid: Grid, edge: tuple[int, int], along: float, ends: tuple[int, int], found: Found, out: Branches
) -> int:
    """Fill ``out`` with the branches of both ends, followed to a point ``along`` the ``edge`` (vertex, axis)."""
    shape, origin, steps = grid
    links, limits = scene[0][0], scene[3]
    dof = links.shape[0] - 1
    frames, x, target, q = np.empty((dof + 2, 12)), np.zeros(5), np.empty(12), np.empty(dof)
    at = place_of(shape, edge[0])
    for axis in range(4):
        x[axis] = origin[axis] + steps[axis] * (at[axis] + (along if axis == edge[1] else 0.0))
    fill_row(x, target)
    middle = 0.5 * (limits[0] + limits[1])
    count = 0
    for end in ends:
        for k in range(found[1][end]):
            q[:] = found[0][end, k]
            count = add_branch(links, limits, middle, target, out, count, q, frames)
    return count


@kernel
def halve_edge(
    scene: Scene, grid: Grid, roll_step: float, halvings: int, edge: tuple[int, int], found: Found, shares: Shares
) -> None:
    """Fill the shares of one edge (vertex, axis) for every roll; IK of a point on it is solved once for all rolls."""
    robot, bodies, margins, _ = scene
    branches, _, reachable = found
    n, axis = edge
    other = n + strides_of(grid[0])[axis]
    parts = 2**halvings
    between = np.empty((parts, branches.shape[1], branches.shape[2]), dtype=np.float32)
    solved = np.full(parts, -1, dtype=np.int64)
    for k in range(reachable.shape[1]):
        here = reachable[n, k]
        if here == reachable[other, k]:
            continue
        low, high = 0, parts
        while high - low > 1:
            half = (low + high) // 2
            if solved[half] < 0:
                ends = (n, other) if here else (other, n)
                solved[half] = branches_between(scene, grid, edge, half / parts, ends, found, between[half])
            if any_free(robot, bodies, margins, between[half], int(solved[half]), roll_step * k) == here:
                low = half
            else:
                high = half
        shares[n, k, axis] = low + high


@kernel
def find_place_borders(
    scene: Scene,
    grid: Grid,
    wanted: NDArray[np.bool_],
    roll_step: float,
    halvings: int,
    span: tuple[int, int],
    found: Found,
    shares: Shares,
) -> None:
    """Halve every edge along rho, z, u or v between a reachable and an unreachable vertex."""
    shape = grid[0]
    reachable = found[2]
    strides = strides_of(shape)
    for n in range(span[0], span[1]):
        at = place_of(shape, n)
        if not wanted[at[2], at[3]]:
            continue
        for axis in range(4):
            if at[axis] + 1 >= shape[axis]:
                continue
            next_at = place_of(shape, n + strides[axis])
            if not wanted[next_at[2], next_at[3]]:
                continue
            if np.any(reachable[n] != reachable[n + strides[axis]]):
                halve_edge(scene, grid, roll_step, halvings, (n, axis), found, shares)


@kernel
def fill_near(grid: Grid, metres_per_radian: float, halvings: int, shares: Shares, distance: Array) -> None:
    """Distance (vertices, rolls) to the border where it crosses one of a vertex's own edges, else infinity.

    The border is taken for a plane through the crossings: 1 / d^2 is the sum of 1 / (its distance along an axis)^2.
    """
    shape, origin, steps = grid
    total, rolls = distance.shape
    strides = strides_of(shape)
    h = np.empty(5)
    unit = 1.0 / 2 ** (halvings + 1)
    for n in range(total):
        at = place_of(shape, n)
        fill_steps(origin[2] + steps[2] * at[2], origin[3] + steps[3] * at[3], steps, metres_per_radian, h)
        for k in range(rolls):
            inverse_square = 0.0
            for axis in range(5):
                nearest = np.inf
                if shares[n, k, axis] != NONE:
                    nearest = unit * shares[n, k, axis]
                if axis == 4:
                    if shares[n, k - 1, 4] != NONE:
                        nearest = min(nearest, 1.0 - unit * shares[n, k - 1, 4])
                elif at[axis] > 0 and shares[n - strides[axis], k, axis] != NONE:
                    nearest = min(nearest, 1.0 - unit * shares[n - strides[axis], k, axis])
                inverse_square += 1.0 / (nearest * h[axis]) ** 2
            distance[n, k] = 1.0 / np.sqrt(inverse_square) if inverse_square > 0.0 else np.inf


@kernel
def neighbours(
    shape: Shape, n: int, k: int, cap_m: float, distance: Array, h: Array, near: Array, weight: Array
) -> int:
    """Fill ``near`` with the smaller neighbour's distance on each axis, smallest first, and ``weight`` with 1 / h^2.

    Axes without a neighbour below the cap are left out; how many are not.
    """
    at, strides, rolls = place_of(shape, n), strides_of(shape), shape[4]
    count = 0
    for axis in range(5):
        value = cap_m
        if axis == 4:
            value = min(distance[n, k - 1], distance[n, (k + 1) % rolls])
        else:
            if at[axis] > 0:
                value = min(value, distance[n - strides[axis], k])
            if at[axis] + 1 < shape[axis]:
                value = min(value, distance[n + strides[axis], k])
        if value >= cap_m:
            continue
        slot = count
        while slot > 0 and near[slot - 1] > value:
            near[slot], weight[slot] = near[slot - 1], weight[slot - 1]
            slot -= 1
        near[slot], weight[slot] = value, 1.0 / h[axis] ** 2
        count += 1
    return count


@kernel
def upwind(near: Array, weight: Array, count: int, cap_m: float) -> float:
    """The distance that |gradient| = 1 gives from the neighbours below it, at most the cap."""
    best = cap_m
    a = b = c = 0.0
    for j in range(count):
        if near[j] >= best:
            break
        a += weight[j]
        b += weight[j] * near[j]
        c += weight[j] * near[j] ** 2
        best = min(best, (b + np.sqrt(max(b * b - a * (c - 1.0), 0.0))) / a)
    return best


@kernel
def sweep(
    grid: Grid,
    metres_per_radian: float,
    wanted: NDArray[np.bool_],
    fixed: NDArray[np.bool_],
    backwards: bool,
    cap_m: float,
    distance: Array,
) -> float:
    """One Gauss-Seidel walk of |gradient| = 1 (first order, upwind; Zhao 2005); the largest change in metres."""
    shape, origin, steps = grid
    total = distance.shape[0]
    h, near, weight = np.empty(5), np.empty(5), np.empty(5)
    largest = 0.0
    for i in range(total):
        n = total - 1 - i if backwards else i
        at = place_of(shape, n)
        if not wanted[at[2], at[3]]:
            continue
        fill_steps(origin[2] + steps[2] * at[2], origin[3] + steps[3] * at[3], steps, metres_per_radian, h)
        for k in range(distance.shape[1]):
            if fixed[n, k]:
                continue
            best = upwind(near, weight, neighbours(shape, n, k, cap_m, distance, h, near, weight), cap_m)
            if best < distance[n, k]:
                largest = max(largest, distance[n, k] - best)
                distance[n, k] = best
    return largest
