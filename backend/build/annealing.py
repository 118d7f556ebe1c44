"""Grasp candidates by simulated annealing of the hand's pose and opening against a contact energy.

The energy is that of GraspIt!'s planner (Ciocarlie and Allen, "Hand Posture Subspaces for Dexterous Robotic
Grasping", IJRR 2009), for two parallel pads: how far points of the pads are from the object's surface, and how far
their normals are from facing its own; a hand that enters object or tray on its way in costs extra.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from backend.build.hand_points import hand_points
from backend.build.object_field import FieldArrays, ObjectField, distance_at
from backend.kinematics.compiled import kernel
from backend.objects import ObjectDescription
from backend.pose import Array
from backend.robots.models import RobotModel
from backend.tasks.setup import TRAY_THICKNESS_M, tray_size_m

STEPS = 260
COARSE = 7
"""While annealing one point of the hand in so many is looked at; in the end all."""
STATIONS = (0.0, 0.5, 1.0)
"""Shares of the way back to the pregrasp at which the open hand must be clear."""
MOST_UPWARD = 0.05
"""Largest z of an approach direction: the object stands on its tray."""
CLEAR_M = 0.0055
TRAY_CLEAR_M = 0.006
SPARE_M = 0.006
"""The open hand is at least this much wider than what it closes on."""
ACCEPTED = 0.45
"""Largest contact energy of a candidate: pads within a few millimetres, normals within about 30 degrees."""
CHAINS_AT_ONCE = 400

HandArrays = tuple[Array, Array, Array, Array]
"""pad points (m, 3) for opening zero; their inward normals (m, 3); all and few points of the open hand (n, 3)."""
PlaceArrays = tuple[FieldArrays, Array]
"""the object's field; (3,) half length and width of the tray, and its thickness."""


@dataclass(frozen=True, eq=False)
class Annealed:
    """What one batch of chains ended in."""

    Ts_object_grasp: Array
    """(n, 4, 4) of the accepted ones."""
    chains: int
    """How many were run."""


class Annealer:
    """Draws candidates of one object for one hand; same seed, same candidates."""

    def __init__(self, model: RobotModel, target: ObjectDescription, seed: int) -> None:
        gripper = model.description.gripper
        points = hand_points(model)
        pads, normals = _pads(gripper.pad_depth_m)
        self._hand: HandArrays = (pads, normals, points, np.ascontiguousarray(points[::COARSE]))
        size = np.array(tray_size_m(target, 0.0))
        tray = np.array([size[0] / 2, size[1] / 2, TRAY_THICKNESS_M])
        self._place: PlaceArrays = (ObjectField.of(target).arrays, tray)
        self._most_open_m = gripper.opening_m - SPARE_M
        self._back_m = model.description.backoff_m
        bounds = np.concatenate([part.bounds_m for part in target.convex_parts])
        self._box = np.stack([bounds.min(axis=0), bounds.max(axis=0)])
        self._rng = np.random.default_rng(seed)

    def batches(self) -> Iterator[Annealed]:
        """Batches of ``CHAINS_AT_ONCE`` chains, without end."""
        while True:
            Ts, energies = anneal_each(
                self._hand, self._place, self._box, self._most_open_m, self._back_m, CHAINS_AT_ONCE, self._rng
            )
            yield Annealed(Ts[energies <= ACCEPTED], CHAINS_AT_ONCE)


def _pads(depth_m: float) -> tuple[Array, Array]:
    """(12, 3) points of two pads that touch each other at the tcp, and the normals that point between them."""
    points = [(x, 0.0, z) for _ in (1, -1) for x in (-0.006, 0.006) for z in (-depth_m / 4, 0.0, depth_m / 4)]
    normals = [(0.0, -float(side), 0.0) for side in (1, -1) for _ in range(6)]
    return np.array(points), np.array(normals)


@kernel
def contact_energy(hand: HandArrays, place: PlaceArrays, R: Array, p: Array, opening: float) -> float:
    """Mean over the pads' points of distance (in centimetres) and misalignment (0 to 1)."""
    pads, normals, _, _ = hand
    field, _ = place
    h = 0.002
    total = 0.0
    for i in range(pads.shape[0]):
        half = -normals[i, 1] * opening / 2
        x, y, z = pads[i, 0], half, pads[i, 2]
        wx = R[0, 0] * x + R[0, 1] * y + R[0, 2] * z + p[0]
        wy = R[1, 0] * x + R[1, 1] * y + R[1, 2] * z + p[1]
        wz = R[2, 0] * x + R[2, 1] * y + R[2, 2] * z + p[2]
        distance = distance_at(field, wx, wy, wz)
        gx = distance_at(field, wx + h, wy, wz) - distance_at(field, wx - h, wy, wz)
        gy = distance_at(field, wx, wy + h, wz) - distance_at(field, wx, wy - h, wz)
        gz = distance_at(field, wx, wy, wz + h) - distance_at(field, wx, wy, wz - h)
        length = np.sqrt(gx * gx + gy * gy + gz * gz) + 1e-9
        facing = normals[i, 1] * (R[0, 1] * gx + R[1, 1] * gy + R[2, 1] * gz) / length
        total += min(abs(distance), 0.1) / 0.01 + 0.5 * (1.0 + facing)
    return total / pads.shape[0]


@kernel
def intrusion(points: Array, place: PlaceArrays, R: Array, p: Array, back: float) -> float:
    """How far, summed in centimetres, points of the hand are too near to object or tray, ``back`` metres back."""
    field, tray = place
    total = 0.0
    ox, oy, oz = p[0] - back * R[0, 2], p[1] - back * R[1, 2], p[2] - back * R[2, 2]
    for i in range(points.shape[0]):
        x, y, z = points[i]
        wx = R[0, 0] * x + R[0, 1] * y + R[0, 2] * z + ox
        wy = R[1, 0] * x + R[1, 1] * y + R[1, 2] * z + oy
        wz = R[2, 0] * x + R[2, 1] * y + R[2, 2] * z + oz
        ground = 0.0 if abs(wx) < tray[0] + TRAY_CLEAR_M and abs(wy) < tray[1] + TRAY_CLEAR_M else -tray[2]
        total += max(ground + TRAY_CLEAR_M - wz, 0.0)
        total += max(CLEAR_M - distance_at(field, wx, wy, wz), 0.0)
    return total / 0.01


@kernel
def turned(R: Array, x: float, y: float, z: float) -> Array:
    """(3, 3) ``R`` turned by a rotation vector in its own frame."""
    angle = np.sqrt(x * x + y * y + z * z)
    if angle < 1e-12:
        return R.copy()
    x, y, z = x / angle, y / angle, z / angle
    s, c = np.sin(angle), 1.0 - np.cos(angle)
    E = np.empty((3, 3))
    E[0, 0], E[0, 1], E[0, 2] = 1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    E[1, 0], E[1, 1], E[1, 2] = c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x
    E[2, 0], E[2, 1], E[2, 2] = c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)
    out = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            out[i, j] = R[i, 0] * E[0, j] + R[i, 1] * E[1, j] + R[i, 2] * E[2, j]
    return out


@kernel
def random_start(box: Array, most_open: float, rng: np.random.Generator) -> tuple[Array, Array, float]:
    """A hand somewhere at the object, that comes from anywhere but below."""
    z = rng.uniform(-1.0, MOST_UPWARD)
    a = rng.uniform(-np.pi, np.pi)
    r = np.sqrt(1.0 - z * z)
    approach = (r * np.cos(a), r * np.sin(a), z)
    side = (-np.sin(a), np.cos(a), 0.0)
    R = np.empty((3, 3))
    for i in range(3):
        R[i, 1], R[i, 2] = side[i], approach[i]
    R[0, 0] = side[1] * approach[2] - side[2] * approach[1]
    R[1, 0] = side[2] * approach[0] - side[0] * approach[2]
    R[2, 0] = side[0] * approach[1] - side[1] * approach[0]
    p = np.empty(3)
    for i in range(3):
        p[i] = rng.uniform(box[0, i], box[1, i])
    return turned(R, 0.0, 0.0, rng.uniform(-np.pi, np.pi)), p, rng.uniform(0.2, 1.0) * most_open


@kernel
def anneal(
    hand: HandArrays, place: PlaceArrays, box: Array, most_open: float, back: float, rng: np.random.Generator
) -> tuple[Array, Array, float]:
    """One chain: rotation (3, 3), position (3,) and the contact energy, infinite when the hand is not clear."""
    _, _, every, few = hand
    rotation, p, opening = random_start(box, most_open, rng)
    energy = contact_energy(hand, place, rotation, p, opening)
    energy += intrusion(few, place, rotation, p, 0.0) + intrusion(few, place, rotation, p, 0.5 * back)
    for step in range(STEPS):
        heat = 1.0 - step / STEPS
        reach = 0.001 + 0.02 * heat * heat
        turn = rng.normal(0.0, 0.03 + 0.4 * heat * heat, 3)
        rotation1 = turned(rotation, turn[0], turn[1], turn[2])
        if rotation1[2, 2] > MOST_UPWARD:
            continue
        p1 = p + rng.normal(0.0, reach, 3)
        opening1 = min(max(opening + rng.normal(0.0, reach), 0.004), most_open)
        energy1 = contact_energy(hand, place, rotation1, p1, opening1)
        temperature = 0.5 * heat**3 + 0.003
        bar = energy - temperature * np.log(rng.random() + 1e-300)
        if energy1 >= bar:
            continue
        energy1 += intrusion(few, place, rotation1, p1, 0.0) + intrusion(few, place, rotation1, p1, 0.5 * back)
        if energy1 < bar:
            rotation, p, opening, energy = rotation1, p1, opening1, energy1
    for share in STATIONS:
        if intrusion(every, place, rotation, p, share * back) > 0.0:
            return rotation, p, np.inf
    return rotation, p, contact_energy(hand, place, rotation, p, opening)


@kernel
def anneal_each(
    hand: HandArrays,
    place: PlaceArrays,
    box: Array,
    most_open: float,
    back: float,
    count: int,
    rng: np.random.Generator,
) -> tuple[Array, Array]:
    """So many chains: grasps (n, 4, 4) and contact energies (n,)."""
    Ts = np.zeros((count, 4, 4))
    energies = np.empty(count)
    for i in range(count):
        rotation, p, energies[i] = anneal(hand, place, box, most_open, back, rng)
        Ts[i, :3, :3], Ts[i, :3, 3], Ts[i, 3, 3] = rotation, p, 1.0
    return Ts, energies
