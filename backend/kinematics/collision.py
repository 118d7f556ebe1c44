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
RobotArrays = tuple[Array, Array, Array, Integers, Integers]
"""links (dof + 1, 12), spheres (n, 4), groups (g, 4), index (g, 4), pairs (p, 2): see ``SphereModel``."""
BodyArrays = tuple[Array, Array, Integers, Array, Integers, Array]
"""poses (m, 12); shapes (m, 8): bounding sphere, half extents, margin; kinds (m, 4): role, is a box, first
and one past the last part; parts (k, 4): bounding spheres; part_planes (k, 2): first and one past the last
plane; planes (p, 4)."""
Margins = tuple[float, float]
"""Metres to the floor and of the robot to itself; the bodies have their own."""

OBSTACLE, TARGET, TRAY = 0, 1, 2
FREE, FLOOR, BODY, SELF = 0, 1, 2, 3
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
def place(frames: Array, index: Integers, group: int, local: Array, out: Array) -> None:
    """Move the spheres of one group into the world."""
    row = frames[index[group, 0]]
    for s in range(index[group, 1], index[group, 2]):
        out[s, 0], out[s, 1], out[s, 2] = point_in(row, local[s, 0], local[s, 1], local[s, 2])
        out[s, 3] = local[s, 3]


@kernel
def ignored(role: int, flags: int, options: int) -> bool:
    """Whether a group with ``flags`` need not avoid a body of this role."""
    if role != TARGET:
        return False
    return options & WITH_TARGET == 0 or (options & HAND_MAY_TOUCH != 0 and flags & HAND != 0)


@kernel
def spheres_apart(a: Array, b: Array) -> float:
    """Distance between two spheres' surfaces."""
    dx, dy, dz = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return np.sqrt(dx * dx + dy * dy + dz * dz) - a[3] - b[3]


@kernel
def touched_body(
    group: int, around: Array, world: Array, index: Integers, bodies: BodyArrays, options: int
) -> int:
    """The first body that the group's spheres (already in the world) come too near to; -1 when none."""
    for body in range(bodies[0].shape[0]):
        margin = bodies[1][body, 7]
        if ignored(bodies[2][body, 0], index[group, 3], options):
            continue
        reach = around[group, 3] + margin
        x, y, z = around[group, 0], around[group, 1], around[group, 2]
        if distance_to_body(body, bodies, x, y, z, reach) >= reach:
            continue
        for s in range(index[group, 1], index[group, 2]):
            reach = world[s, 3] + margin
            if distance_to_body(body, bodies, world[s, 0], world[s, 1], world[s, 2], reach) < reach:
                return body
    return -1


@kernel
def touched_self(index: Integers, pairs: Integers, around: Array, world: Array, margin: float) -> int:
    """The first pair of groups closer than ``margin``; -1 when none."""
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if spheres_apart(around[a], around[b]) >= margin:
            continue
        for s in range(index[a, 1], index[a, 2]):
            if spheres_apart(world[s], around[b]) >= margin:
                continue
            for t in range(index[b, 1], index[b, 2]):
                if spheres_apart(world[s], world[t]) < margin:
                    return p
    return -1


@kernel
def contact(
    robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, q: Array
) -> tuple[int, int, int]:
    """What touches first: (FREE, -1, -1), (FLOOR, group, -1), (BODY, group, body) or (SELF, pair, -1)."""
    links, spheres, groups, index, pairs = robot
    frames = np.empty((links.shape[0] + 1, 12))
    around, world = np.empty(groups.shape), np.empty(spheres.shape)
    move_bodies(links, q, frames)
    for g in range(groups.shape[0]):
        row = frames[index[g, 0]]
        around[g, 0], around[g, 1], around[g, 2] = point_in(row, groups[g, 0], groups[g, 1], groups[g, 2])
        around[g, 3] = groups[g, 3]
        place(frames, index, g, spheres, world)
        if index[g, 0] == 0:
            continue
        if index[g, 3] & LEVEL == 0 and around[g, 2] < around[g, 3] + margins[0]:
            for s in range(index[g, 1], index[g, 2]):
                if world[s, 2] < world[s, 3] + margins[0]:
                    return FLOOR, g, -1
        body = touched_body(g, around, world, index, bodies, options)
        if body >= 0:
            return BODY, g, body
    pair = touched_self(index, pairs, around, world, margins[1])
    return (SELF, pair, -1) if pair >= 0 else (FREE, -1, -1)


@kernel
def free(robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, q: Array) -> bool:
    """Whether nothing touches."""
    return contact(robot, bodies, margins, options, q)[0] == FREE


@kernel
def free_each(
    robot: RobotArrays, bodies: BodyArrays, margins: Margins, options: int, qs: Array
) -> NDArray[np.bool_]:
    """(n,) whether nothing touches, for every row of ``qs`` (n, dof)."""
    out = np.empty(qs.shape[0], dtype=np.bool_)
    for i in range(qs.shape[0]):
        out[i] = contact(robot, bodies, margins, options, qs[i])[0] == FREE
    return out


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
    links, spheres, groups, index, pairs = robot
    frames, world = np.empty((links.shape[0] + 1, 12)), np.empty(spheres.shape)
    move_bodies(links, q, frames)
    best = cap
    for g in range(groups.shape[0]):
        place(frames, index, g, spheres, world)
        if index[g, 0] == 0:
            continue
        for s in range(index[g, 1], index[g, 2]):
            x, y, z, r = world[s, 0], world[s, 1], world[s, 2], world[s, 3]
            if index[g, 3] & LEVEL == 0:
                best = min(best, z - r)
            for body in range(bodies[0].shape[0]):
                if not ignored(bodies[2][body, 0], index[g, 3], options):
                    best = min(best, distance_to_body(body, bodies, x, y, z, best + r) - r)
    for p in range(pairs.shape[0]):
        for s in range(index[pairs[p, 0], 1], index[pairs[p, 0], 2]):
            for t in range(index[pairs[p, 1], 1], index[pairs[p, 1], 2]):
                best = min(best, spheres_apart(world[s], world[t]))
    return best
