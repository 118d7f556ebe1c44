"""Kernels that tell how far bodies and the robot's own links are, and in which direction that distance grows."""

from __future__ import annotations

import numpy as np

from backend.kinematics.collision import BodyArrays, RobotArrays, past, point_in, point_seen_from
from backend.kinematics.compiled import kernel
from backend.pose import Array

Slope = tuple[float, float, float, float]
"""Signed distance in metres, then its gradient: a unit vector, away from the body."""


@kernel
def slope_of_box(shape: Array, x: float, y: float, z: float) -> Slope:
    """Signed distance of a point in the box's frame, and its gradient in that frame."""
    dx, dy, dz = abs(x) - shape[4], abs(y) - shape[5], abs(z) - shape[6]
    sx, sy, sz = np.copysign(1.0, x), np.copysign(1.0, y), np.copysign(1.0, z)
    if max(dx, dy, dz) > 0.0:
        ox, oy, oz = max(dx, 0.0), max(dy, 0.0), max(dz, 0.0)
        away = np.sqrt(ox * ox + oy * oy + oz * oz)
        return away, sx * ox / away, sy * oy / away, sz * oz / away
    if dx >= dy and dx >= dz:
        return dx, sx, 0.0, 0.0
    if dy >= dz:
        return dy, 0.0, sy, 0.0
    return dz, 0.0, 0.0, sz


@kernel
def slope_of_parts(body: int, bodies: BodyArrays, x: float, y: float, z: float, enough: float) -> Slope:
    """At most the distance of a point in the body's frame, as ``distance_to_parts`` has it, and its gradient.

    At ``enough`` and beyond the distance is ``enough`` and the gradient zero.
    """
    _, _, kinds, parts, part_planes, planes = bodies
    nearest, steepest = enough, -1
    for k in range(kinds[body, 2], kinds[body, 3]):
        dx, dy, dz = x - parts[k, 0], y - parts[k, 1], z - parts[k, 2]
        if np.sqrt(dx * dx + dy * dy + dz * dz) - parts[k, 3] >= nearest:
            continue
        largest, active = -np.inf, -1
        for p in range(part_planes[k, 0], part_planes[k, 1]):
            height = planes[p, 0] * x + planes[p, 1] * y + planes[p, 2] * z - planes[p, 3]
            if height > largest:
                largest, active = height, p
                if largest >= nearest:
                    break
        if largest < nearest:
            nearest, steepest = largest, active
    if steepest < 0:
        return enough, 0.0, 0.0, 0.0
    return nearest, planes[steepest, 0], planes[steepest, 1], planes[steepest, 2]


@kernel
def slope_of_body(body: int, bodies: BodyArrays, x: float, y: float, z: float, enough: float) -> Slope:
    """Signed distance of a point in the world to a body, and its gradient in world axes; see ``slope_of_parts``."""
    row, shape = bodies[0][body], bodies[1][body]
    u, v, w = point_seen_from(row, x, y, z)
    dx, dy, dz = u - shape[0], v - shape[1], w - shape[2]
    if np.sqrt(dx * dx + dy * dy + dz * dz) - shape[3] >= enough:
        return enough, 0.0, 0.0, 0.0
    if bodies[2][body, 1] == 1:
        distance, gu, gv, gw = slope_of_box(shape, u, v, w)
    else:
        distance, gu, gv, gw = slope_of_parts(body, bodies, u, v, w, enough)
    if distance >= enough:
        return enough, 0.0, 0.0, 0.0
    return (
        distance,
        row[0] * gu + row[1] * gv + row[2] * gw,
        row[3] * gu + row[4] * gv + row[5] * gw,
        row[6] * gu + row[7] * gv + row[8] * gw,
    )


@kernel
def nearest_nodes(robot: RobotArrays, frames: Array, a: int, b: int, enough: float) -> tuple[float, int, int]:
    """The two spheres of two groups that are nearest to each other, and how far apart.

    Where none are nearer than ``enough``: ``enough`` and -1, -1.
    """
    _, nodes, skips, trees, _ = robot
    row_a, row_b = frames[trees[a, 0]], frames[trees[b, 0]]
    one, other = -1, -1
    m = int(trees[a, 1])
    while m < trees[a, 2]:
        x, y, z = point_in(row_a, nodes[m, 0], nodes[m, 1], nodes[m, 2])
        x, y, z = point_seen_from(row_b, x, y, z)
        n = int(trees[b, 1])
        stop = int(trees[b, 2]) if skips[m] < 0 else n + 1
        near = False
        while n < stop:
            dx, dy, dz = x - nodes[n, 0], y - nodes[n, 1], z - nodes[n, 2]
            apart = np.sqrt(dx * dx + dy * dy + dz * dz) - nodes[n, 3] - nodes[m, 3]
            if apart < enough:
                near = True
                if skips[n] < 0 and skips[m] < 0:
                    enough, one, other = apart, m, n
                n += 1
            else:
                n = past(skips, n)
        m = m + 1 if near else past(skips, m)
    return enough, one, other
