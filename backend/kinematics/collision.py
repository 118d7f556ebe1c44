"""Kernels that tell whether a robot's spheres touch anything: floor, convex bodies, or the robot itself.

A convex body is a set of half-spaces (normal, offset) around each part; the largest signed distance to them
never exceeds the true distance, so what is called free is free.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.chain import move_bodies
from backend.kinematics.compiled import kernel
from backend.kinematics.spheres import HAND, LEVEL
from backend.pose import Array

Integers = NDArray[np.int64]
RobotArrays = tuple[Array, Array, Integers, Integers, Integers]
"""links (dof + 1, 12), nodes (m, 4), skips (m,), trees (g, 4), pairs (p, 2): see ``SphereModel``."""
BodyArrays = tuple[Array, Array, Integers, Array, Integers, Array]
"""poses (m, 12); shapes (m, 8): bounding sphere, half extents, margin; kinds (m, 4): role, is a box, first
and one past the last part; parts (k, 4): bounding spheres; part_planes (k, 2): first and one past the last
plane; planes (p, 4)."""
Margins = tuple[float, float]
"""Metres to the floor and of the robot to itself; the bodies have their own."""

OBSTACLE, TARGET, TRAY = 0, 1, 2
FREE, FLOOR, BODY, SELF = 0, 1, 2, 3
ROUNDING_M = 1e-9
"""Bounds are this much larger, so that they never rule out what is looked at more closely after."""
WITH_TARGET = 1
"""Option: the target is there."""
HAND_MAY_TOUCH = 2
"""Option: the hand may touch the target."""


@kernel
def point_in(row: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """A point of the frame ``row``, seen from outside."""
    return (
        row[0] * x + row[1] * y + row[2] * z + row[9],
        row[3] * x + row[4] * y + row[5] * z + row[10],
        row[6] * x + row[7] * y + row[8] * z + row[11],
    )


@kernel
def point_seen_from(row: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """An outside point, seen from the frame ``row``."""
    x, y, z = x - row[9], y - row[10], z - row[11]
    return (
        row[0] * x + row[3] * y + row[6] * z,
        row[1] * x + row[4] * y + row[7] * z,
        row[2] * x + row[5] * y + row[8] * z,
    )


@kernel
def distance_to_box(shape: Array, x: float, y: float, z: float) -> float:
    """Signed distance of a point in the box's frame to its surface."""
    dx, dy, dz = abs(x) - shape[4], abs(y) - shape[5], abs(z) - shape[6]
    ox, oy, oz = max(dx, 0.0), max(dy, 0.0), max(dz, 0.0)
    return np.sqrt(ox * ox + oy * oy + oz * oz) + min(max(dx, dy, dz), 0.0)


@kernel
def distance_to_parts(body: int, bodies: BodyArrays, x: float, y: float, z: float, enough: float) -> float:
    """At most the distance of a point in the body's frame to the body; above ``enough`` it is just far."""
    _, _, kinds, parts, part_planes, planes = bodies
    nearest = np.inf
    for k in range(kinds[body, 2], kinds[body, 3]):
        dx, dy, dz = x - parts[k, 0], y - parts[k, 1], z - parts[k, 2]
        bound = np.sqrt(dx * dx + dy * dy + dz * dz) - parts[k, 3]
        if bound >= min(nearest, enough):
            nearest = min(nearest, bound)
            continue
        largest = -np.inf
        for p in range(part_planes[k, 0], part_planes[k, 1]):
            height = planes[p, 0] * x + planes[p, 1] * y + planes[p, 2] * z - planes[p, 3]
            if height > largest:
                largest = height
                if largest >= enough:
                    break
        nearest = min(nearest, largest)
    return nearest


@kernel
def distance_to_body(body: int, bodies: BodyArrays, x: float, y: float, z: float, enough: float) -> float:
    """As ``distance_to_parts``, of a point in the world."""
    u, v, w = point_seen_from(bodies[0][body], x, y, z)
    shape = bodies[1][body]
    dx, dy, dz = u - shape[0], v - shape[1], w - shape[2]
    bound = np.sqrt(dx * dx + dy * dy + dz * dz) - shape[3]
    if bound >= enough:
        return bound
    if bodies[2][body, 1] == 1:
        return distance_to_box(shape, u, v, w)
    return distance_to_parts(body, bodies, u, v, w, enough)


@kernel
def ignored(role: int, flags: int, options: int) -> bool:
    """Whether a group with ``flags`` need not avoid a body of this role."""
    if role != TARGET:
        return False
    return options & WITH_TARGET == 0 or (options & HAND_MAY_TOUCH != 0 and flags & HAND != 0)


@kernel
def past(skips: Integers, node: int) -> int:
    """The node to go on with when a node's subtree is ruled out."""
    return max(skips[node], node + 1)


@kernel
def touches_body(robot: RobotArrays, row: Array, group: int, body: int, bodies: BodyArrays, margin: float) -> bool:
    """Whether a sphere of the group, carried by the frame ``row``, is nearer to a body than ``margin``."""
    _, nodes, skips, trees, _ = robot
    node = int(trees[group, 1])
    while node < trees[group, 2]:
        x, y, z = point_in(row, nodes[node, 0], nodes[node, 1], nodes[node, 2])
        reach = nodes[node, 3] + margin
        if distance_to_body(body, bodies, x, y, z, reach) < reach:
            if skips[node] < 0:
                return True
            node += 1
        else:
            node = past(skips, node)
    return False


@kernel
def touches_floor(robot: RobotArrays, row: Array, group: int, margin: float) -> bool:
    """Whether a sphere of the group, carried by the frame ``row``, is nearer to the floor than ``margin``."""
    _, nodes, skips, trees, _ = robot
    node = int(trees[group, 1])
    while node < trees[group, 2]:
        height = row[6] * nodes[node, 0] + row[7] * nodes[node, 1] + row[8] * nodes[node, 2] + row[11]
        if height < nodes[node, 3] + margin:
            if skips[node] < 0:
                return True
            node += 1
        else:
            node = past(skips, node)
    return False


@kernel
def groups_apart(robot: RobotArrays, frames: Array, a: int, b: int, enough: float) -> float:
    """Distance between the spheres of two groups where it is less than ``enough``, else ``enough``."""
    _, nodes, skips, trees, _ = robot
    row_a, row_b = frames[trees[a, 0]], frames[trees[b, 0]]
    between = np.empty(12)
    for i in range(3):
        for j in range(3):
            between[3 * i + j] = row_b[i] * row_a[j] + row_b[3 + i] * row_a[3 + j] + row_b[6 + i] * row_a[6 + j]
    between[9], between[10], between[11] = point_seen_from(row_b, row_a[9], row_a[10], row_a[11])
    root = int(trees[b, 1])
    m = int(trees[a, 1])
    while m < trees[a, 2]:
        x, y, z = point_in(between, nodes[m, 0], nodes[m, 1], nodes[m, 2])
        n = root
        stop = int(trees[b, 2]) if skips[m] < 0 else root + 1
        near = False
        while n < stop:
            dx, dy, dz = x - nodes[n, 0], y - nodes[n, 1], z - nodes[n, 2]
            apart = np.sqrt(dx * dx + dy * dy + dz * dz) - nodes[n, 3] - nodes[m, 3]
            if apart < enough:
                near = True
                if skips[n] < 0 and skips[m] < 0:
                    enough = apart
                n += 1
            else:
                n = past(skips, n)
        m = m + 1 if near else past(skips, m)
    return enough


@kernel
def spheres_near(a: Array, b: Array, margin: float) -> bool:
    """Whether two spheres (x, y, z, radius) are nearer to each other than ``margin``."""
    dx, dy, dz = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    reach = a[3] + b[3] + margin + ROUNDING_M
    return dx * dx + dy * dy + dz * dz < reach * reach


@kernel
def contact(robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, q: Array) -> tuple[int, int, int]:
    """What touches first: (FREE, -1, -1), (FLOOR, group, -1), (BODY, group, body) or (SELF, pair, -1)."""
    links, nodes, _, trees, pairs = robot
    frames = np.empty((links.shape[0] + 1, 12))
    move_bodies(links, q, frames)
    roots = np.empty((trees.shape[0], 4))
    for g in range(trees.shape[0]):
        root = nodes[trees[g, 1]]
        roots[g, 0], roots[g, 1], roots[g, 2] = point_in(frames[trees[g, 0]], root[0], root[1], root[2])
        roots[g, 3] = root[3]
    bounds = np.empty((bodies[0].shape[0], 4))
    for body in range(bodies[0].shape[0]):
        shape = bodies[1][body]
        bounds[body, 0], bounds[body, 1], bounds[body, 2] = point_in(bodies[0][body], shape[0], shape[1], shape[2])
        bounds[body, 3] = shape[3]
    for g in range(trees.shape[0]):
        row = frames[trees[g, 0]]
        if trees[g, 0] == 0:
            continue
        if trees[g, 3] & LEVEL == 0 and touches_floor(robot, row, g, margins[0]):
            return FLOOR, g, -1
        for body in range(bodies[0].shape[0]):
            if ignored(bodies[2][body, 0], trees[g, 3], options):
                continue
            margin = bodies[1][body, 7]
            if spheres_near(roots[g], bounds[body], margin) and touches_body(robot, row, g, body, bodies, margin):
                return BODY, g, body
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if spheres_near(roots[a], roots[b], margins[1]) and groups_apart(robot, frames, a, b, margins[1]) < margins[1]:
            return SELF, p, -1
    return FREE, -1, -1


@kernel
def free(robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, q: Array) -> bool:
    """Whether nothing touches."""
    return contact(robot, bodies, margins, options, q)[0] == FREE


@kernel
def free_each(robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, qs: Array) -> NDArray[np.bool_]:
    """(n,) whether nothing touches, for every row of ``qs`` (n, dof)."""
    out = np.empty(qs.shape[0], dtype=np.bool_)
    for i in range(qs.shape[0]):
        out[i] = contact(robot, bodies, margins, options, qs[i])[0] == FREE
    return out


@kernel
def contact_each(robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, qs: Array) -> Integers:
    """(n, 3) what touches first, see ``contact``, for every row of ``qs`` (n, dof)."""
    out = np.empty((qs.shape[0], 3), dtype=np.int64)
    for i in range(qs.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = contact(robot, bodies, margins, options, qs[i])
    return out


@kernel
def first_contact(
    robot: RobotArrays,
    bodies: BodyArrays,
    margins: Margins,
    options: int,
    qs: Array,
    moving: Integers,
    rows: Array,
) -> tuple[int, int, int, int]:
    """Of postures (n, dof) the first that touches anything, and its ``contact``; -1 when all are free.

    By posture i the bodies ``moving`` (k,) are at ``rows[i]`` (n, k, 12); the others stay.
    """
    poses = bodies[0].copy()
    now = (poses, bodies[1], bodies[2], bodies[3], bodies[4], bodies[5])
    for i in range(qs.shape[0]):
        for k in range(moving.shape[0]):
            poses[moving[k]] = rows[i, k]
        kind, one, other = contact(robot, now, margins, options, qs[i])
        if kind != FREE:
            return i, kind, one, other
    return -1, FREE, -1, -1


@kernel
def edge_checks(
    robot: RobotArrays,
    bodies: BodyArrays,
    margins: Margins,
    options: int,
    q0: Array,
    q1: Array,
    resolution: float,
) -> int:
    """State checks a straight edge from free ``q0`` to ``q1`` cost: positive when free, negative when not.

    The end is checked first, then the middle, then the middles of the halves: a blocked edge is found early.
    """
    steps = max(1, int(np.ceil(np.max(np.abs(q1 - q0)) / resolution)))
    checks = 1
    if contact(robot, bodies, margins, options, q1)[0] != FREE:
        return -1
    stride = 1
    while stride < steps:
        stride *= 2
    q = np.empty(q0.shape[0])
    while stride > 1:
        half = stride // 2
        for k in range(half, steps, stride):
            for j in range(q.shape[0]):
                q[j] = q0[j] + (q1[j] - q0[j]) * (k / steps)
            checks += 1
            if contact(robot, bodies, margins, options, q)[0] != FREE:
                return -checks
        stride = half
    return checks


@kernel
def smallest_distance(robot: RobotArrays, bodies: BodyArrays, options: int, cap: float, q: Array) -> float:
    """At most the distance between the robot and everything else including itself, cut at ``cap``."""
    links, nodes, skips, trees, pairs = robot
    frames = np.empty((links.shape[0] + 1, 12))
    move_bodies(links, q, frames)
    best = cap
    for g in range(trees.shape[0]):
        row = frames[trees[g, 0]]
        if trees[g, 0] == 0:
            continue
        for body in range(-1, bodies[0].shape[0]):
            if body < 0 and trees[g, 3] & LEVEL != 0:
                continue
            if body >= 0 and ignored(bodies[2][body, 0], trees[g, 3], options):
                continue
            node = int(trees[g, 1])
            while node < trees[g, 2]:
                x, y, z = point_in(row, nodes[node, 0], nodes[node, 1], nodes[node, 2])
                reach = best + nodes[node, 3]
                distance: float = z if body < 0 else distance_to_body(body, bodies, x, y, z, reach)
                if distance < reach:
                    if skips[node] < 0:
                        best = distance - nodes[node, 3]
                    node += 1
                else:
                    node = past(skips, node)
    for p in range(pairs.shape[0]):
        best = groups_apart(robot, frames, pairs[p, 0], pairs[p, 1], best)
    return best
