"""CHOMP's obstacle cost: how deep the robot's spheres move through what is near, and the exact gradient of that.

Every sphere u has a cost c_u(q) of being near to bodies, to the floor and to other links (Ratliff, Zucker, Bagnell
and Srinivasa 2009, section III-B). A path's cost is its integral over the length of the sphere's way through the world,
so that timing does not matter to it; by the trapezoidal rule, sum_i (c_i + c_i+1) / 2 |x_i+1 - x_i|, whose gradient is
taken as it stands. Of two links that are near each other the two nearest spheres are charged.
"""

from __future__ import annotations

import numpy as np

from backend.kinematics.chain import move_bodies
from backend.kinematics.collision import ignored, past, point_in
from backend.kinematics.compiled import kernel
from backend.kinematics.slopes import nearest_nodes, slope_of_body
from backend.kinematics.spheres import LEVEL
from backend.pipeline.plan.edges import SceneArrays
from backend.pose import Array

Vector = tuple[float, float, float]
SELF_SHARE = 0.4
"""Links may be this much nearer to each other than to bodies before it costs: neighbours are always near."""
LEAST_WAY_M = 1e-9
"""A sphere that moves less stands still; its direction means nothing."""


@kernel
def hinge(distance: float, reach: float) -> tuple[float, float]:
    """Cost of a signed distance, and its derivative: linear inside, quadratic out to ``reach``, then zero."""
    if distance >= reach:
        return 0.0, 0.0
    if distance < 0.0:
        return 0.5 * reach - distance, -1.0
    return 0.5 * (distance - reach) ** 2 / reach, (distance - reach) / reach


@kernel
def add_turned(frames: Array, body: int, point: Vector, g: Vector, out: Array) -> None:
    """Add J^T g to ``out`` (dof,), J being the Jacobian of a world point that rides on ``body``."""
    for j in range(body):
        row = frames[j + 1]
        rx, ry, rz = point[0] - row[9], point[1] - row[10], point[2] - row[11]
        ax, ay, az = row[2], row[5], row[8]
        out[j] += g[0] * (ay * rz - az * ry) + g[1] * (az * rx - ax * rz) + g[2] * (ax * ry - ay * rx)


@kernel
def charge(cost: float, node: int, costs: Array, slopes: Array) -> None:
    """Add a cost to one sphere's; what is to be added to its gradient can be added after."""
    if costs[node] == 0.0:
        slopes[node] = 0.0
    costs[node] += cost


@kernel
def charge_group(
    scene: SceneArrays, frames: Array, group: int, body: int, reach: float, costs: Array, slopes: Array
) -> float:
    """Charge a group's spheres for one body, the floor when ``body`` is -1; the least distance within reach."""
    robot, bodies, margins, _ = scene
    _, nodes, skips, trees, _ = robot
    row, carrier = frames[trees[group, 0]], trees[group, 0]
    margin = margins[0] if body < 0 else bodies[1][body, 7]
    least = reach
    node = int(trees[group, 1])
    while node < trees[group, 2]:
        x, y, z = point_in(row, nodes[node, 0], nodes[node, 1], nodes[node, 2])
        around = nodes[node, 3] + margin
        distance, gx, gy, gz = z, 0.0, 0.0, 1.0
        if body >= 0:
            distance, gx, gy, gz = slope_of_body(body, bodies, x, y, z, around + reach)
        if distance >= around + reach:
            node = past(skips, node)
            continue
        if skips[node] < 0:
            cost, slope = hinge(distance - around, reach)
            charge(cost, node, costs, slopes)
            add_turned(frames, carrier, (x, y, z), (slope * gx, slope * gy, slope * gz), slopes[node])
            least = min(least, distance - around)
        node += 1
    return least


@kernel
def charge_pair(
    scene: SceneArrays, frames: Array, pair: int, reach: float, centers: Array, costs: Array, slopes: Array
) -> float:
    """Charge the two nearest spheres of two links for each other; their distance, at most ``reach``."""
    robot, _, margins, _ = scene
    _, _, _, trees, pairs = robot
    a, b = pairs[pair, 0], pairs[pair, 1]
    apart, m, n = nearest_nodes(robot, frames, a, b, reach + margins[1])
    if m < 0:
        return reach
    cost, slope = hinge(apart - margins[1], reach)
    x, y, z = centers[m]
    u, v, w = centers[n]
    pull = slope / max(np.sqrt((x - u) ** 2 + (y - v) ** 2 + (z - w) ** 2), LEAST_WAY_M)
    gx, gy, gz = pull * (x - u), pull * (y - v), pull * (z - w)
    for node in (m, n):
        charge(cost, node, costs, slopes)
        add_turned(frames, trees[a, 0], (x, y, z), (gx, gy, gz), slopes[node])
        add_turned(frames, trees[b, 0], (u, v, w), (-gx, -gy, -gz), slopes[node])
    return apart - margins[1]


@kernel
def charge_posture(
    scene: SceneArrays, frames: Array, reach: float, centers: Array, costs: Array, slopes: Array
) -> float:
    """Fill every sphere's centre (m, 3), cost (m,) and gradient (m, dof, where it costs); the least distance.

    Distances are what is left of them beyond the scene's margins: a posture is free when none is negative.
    """
    robot, bodies, _, options = scene
    _, nodes, skips, trees, pairs = robot
    costs[:] = 0.0
    least = reach
    for g in range(trees.shape[0]):
        row = frames[trees[g, 0]]
        for node in range(trees[g, 1], trees[g, 2]):
            if skips[node] < 0:
                centers[node] = point_in(row, nodes[node, 0], nodes[node, 1], nodes[node, 2])
        if trees[g, 0] == 0:
            continue
        for body in range(-1, bodies[0].shape[0]):
            unseen = trees[g, 3] & LEVEL != 0 if body < 0 else ignored(bodies[2][body, 0], trees[g, 3], options)
            if not unseen:
                least = min(least, charge_group(scene, frames, g, body, reach, costs, slopes))
    for p in range(pairs.shape[0]):
        least = min(least, charge_pair(scene, frames, p, SELF_SHARE * reach, centers, costs, slopes))
    return least


@kernel
def obstacle_cost(scene: SceneArrays, qs: Array, reach: float, gradient: Array) -> tuple[float, float]:
    """Cost in m^2 of a path (n, dof), and the least distance in metres within ``SELF_SHARE * reach``.

    ``gradient`` (n, dof) is filled with the cost's gradient; its first and last row stay zero.
    """
    robot = scene[0]
    n, dof, m = qs.shape[0], qs.shape[1], robot[1].shape[0]
    frames = np.empty((n, dof + 2, 12))
    centers, costs, slopes = np.zeros((n, m, 3)), np.empty((n, m)), np.empty((n, m, dof))
    least = reach
    for i in range(n):
        move_bodies(robot[0], qs[i], frames[i])
        least = min(least, charge_posture(scene, frames[i], reach, centers[i], costs[i], slopes[i]))
    total = 0.0
    gradient[:] = 0.0
    for g in range(robot[3].shape[0]):
        for node in range(robot[3][g, 1], robot[3][g, 2]):
            if robot[2][node] < 0:
                total += sphere_cost(
                    frames, robot[3][g, 0], centers[:, node], costs[:, node], slopes[:, node], gradient
                )
    return total, least


@kernel
def sphere_cost(frames: Array, body: int, centers: Array, costs: Array, slopes: Array, gradient: Array) -> float:
    """One sphere's share of a path's cost; its gradient is added to ``gradient`` (n, dof)."""
    n = costs.shape[0]
    total = 0.0
    for i in range(n - 1):
        mean = 0.5 * (costs[i] + costs[i + 1])
        if mean == 0.0:
            continue
        dx, dy, dz = (
            centers[i + 1, 0] - centers[i, 0],
            centers[i + 1, 1] - centers[i, 1],
            centers[i + 1, 2] - centers[i, 2],
        )
        way = np.sqrt(dx * dx + dy * dy + dz * dz)
        if way < LEAST_WAY_M:
            continue
        total += mean * way
        pull = mean / way
        for k, sign in ((i, -pull), (i + 1, pull)):
            if k == 0 or k == n - 1:
                continue
            x, y, z = centers[k, 0], centers[k, 1], centers[k, 2]
            add_turned(frames[k], body, (x, y, z), (sign * dx, sign * dy, sign * dz), gradient[k])
            if costs[k] > 0.0:
                for j in range(gradient.shape[1]):
                    gradient[k, j] += 0.5 * way * slopes[k, j]
    return total
