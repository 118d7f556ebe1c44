"""Makes an object of a user's mesh: one closed body, cut into convex parts, lying as it rests."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from backend.build.closed_body import closed_body
from backend.build.convex_parts import closed_parts, cut_into_parts, union_volume_m3
from backend.build.facing import facing_pairs
from backend.build.mesh_file import read_mesh
from backend.build.resting import Rest, is_steady, is_upright, rests, stands
from backend.errors import InvalidInputError
from backend.objects import OBJECTS, Mesh, ObjectDescription
from backend.objects.own import NAME
from backend.pose import Array
from backend.robots import ROBOTS

LEAST_PAIRS = 20
"""A hand fits when this many pairs of 1200 surface points face each other within its opening."""
RESTS_TRIED = 3
MOST_DENSE_KGPM3 = 22_600.0
"""Osmium."""
RANGES = {
    "scale": ("--scale", 1e-9, 1e9),
    "mass_kg": ("--mass-kg", 0.001, 5.0),
    "friction": ("--friction", 0.01, 2.0),
    "most_parts": ("--parts", 1, 64),
    "concavity": ("--concavity", 0.01, 1.0),
    "seed": ("--seed", 0, 2**31 - 1),
}


@dataclass(frozen=True)
class Wanted:
    """What its owner says of an object. Raises ``InvalidInputError`` for what cannot be."""

    name: str
    mass_kg: float
    title: str | None = None
    scale: float = 1.0
    """Metres per unit of the file."""
    upright: bool = False
    """Keep the file's z up (GLB: its y), instead of the likeliest way to rest."""
    color: str = "#9aa7b4"
    friction: float = 0.7
    most_parts: int = 24
    concavity: float = 0.05
    seed: int = 0

    def __post_init__(self) -> None:
        if not NAME.fullmatch(self.name):
            raise InvalidInputError(
                f"--name is of lower-case letters, digits and _, a letter first, at most 40 (got {self.name!r})"
            )
        if self.name in OBJECTS:
            raise InvalidInputError(
                f"{self.name} is the name of an object that comes with the project; choose another."
            )
        for field, (flag, low, high) in RANGES.items():
            value = getattr(self, field)
            if not (math.isfinite(value) and low <= value <= high):
                raise InvalidInputError(f"{flag} must be between {low:g} and {high:g} (got {value:g})")
        if not re.fullmatch(r"#[0-9a-fA-F]{6}", self.color):
            raise InvalidInputError(f"--color is six hexadecimal digits such as '#c83232' (got {self.color!r})")

    @property
    def color_rgb(self) -> tuple[int, int, int]:
        red, green, blue = bytes.fromhex(self.color[1:])
        return red, green, blue


@dataclass(frozen=True, eq=False)
class Made:
    """A finished object, and what was found out about it."""

    described: ObjectDescription
    repairs: tuple[str, ...]
    volume_error: float
    """By how much the union of the parts is larger than the mesh, as a share of the mesh."""
    resting_probability: float
    """Share of random drops that end as it stands now."""
    steady: bool
    """Whether it comes back when it is put down tilted a little; if not, it may roll or topple on a belt."""
    hands: tuple[str, ...]
    """Robots whose hand can go around it somewhere."""


def make_own(path: Path, wanted: Wanted, on_progress: Callable[[str], None]) -> Made:
    """The object of the mesh file ``path``. Same file and wishes, same object.

    Raises ``InvalidInputError`` for a file that no object can be made of, and says what would help.
    """
    body, repairs = closed_body(read_mesh(path, wanted.scale), path.name)
    density = wanted.mass_kg / body.volume_m3
    if density > MOST_DENSE_KGPM3:
        raise InvalidInputError(
            f"{path.name} holds {1e6 * body.volume_m3:.3g} cm^3; with --mass-kg {wanted.mass_kg:g} it would be "
            f"denser than any metal ({density / 1000:.3g} g/cm^3). Is the mass in kilograms, and the scale right?"
        )
    hands = hands_around(_described(path, wanted, body, ()), wanted.seed)
    if not hands:
        raise InvalidInputError(_no_hand(path.name, body))
    on_progress(f"cutting {len(body.faces)} triangles into convex parts (seconds to a few minutes)")
    corners = cut_into_parts(body, wanted.most_parts, wanted.concavity, wanted.seed)
    described, rest, steady = _as_it_rests(path, wanted, body, corners)
    union_m3 = union_volume_m3(described.convex_parts, wanted.seed)
    return Made(described, repairs, union_m3 / body.volume_m3 - 1.0, rest.probability, steady, hands)


def hands_around(described: ObjectDescription, seed: int) -> tuple[str, ...]:
    """Robots whose open hand is wider than the object somewhere, by the pairs of facing points it could close on."""
    openings_m = {name: robot.gripper.opening_m for name, robot in ROBOTS.items()}
    return tuple(name for name, m in openings_m.items() if facing_pairs(described, m, seed) >= LEAST_PAIRS)


def _as_it_rests(path: Path, wanted: Wanted, body: Mesh, corners: list[Array]) -> tuple[ObjectDescription, Rest, bool]:
    """The object lying the likeliest steady way (or upright, if so wanted), and whether that is steady."""
    ways = rests(body, wanted.seed)
    if wanted.upright:
        ways = [way for way in ways if is_upright(way)]
        if not ways:
            raise InvalidInputError(f"{path.name} tips over when it is put down upright; leave out --upright.")
    standing: list[tuple[ObjectDescription, Rest]] = []
    for way in ways[:RESTS_TRIED]:
        described = _lying(path, wanted, body, corners, way)
        if described.convex_parts and stands(described):
            standing.append((described, way))
            if is_steady(described):
                return described, way, True
    if not standing:
        raise InvalidInputError(
            f"{path.name} does not stay where it is put: it rolls or rocks in simulation. Give it a flat place to "
            f"stand on{', or leave out --upright' if wanted.upright else ''}."
        )
    return *standing[0], False


def _lying(path: Path, wanted: Wanted, body: Mesh, corners: list[Array], way: Rest) -> ObjectDescription:
    """The object in its own frame, if it lies that way."""
    T_object_file = _placed(body, way)
    visual = Mesh(_moved(body.vertices, T_object_file), body.faces)
    parts = closed_parts([_moved(points, T_object_file) for points in corners], visual)
    return _described(path, wanted, visual, parts)


def _placed(body: Mesh, way: Rest) -> Array:
    """(4, 4) T_object_file: bottom at z = 0, the middle of what is seen from above at the origin."""
    T = np.eye(4)
    T[:3, :3] = way.rotation
    turned = body.vertices @ way.rotation.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    T[:3, 3] = -(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]
    return T


def _moved(points: Array, T: Array) -> Array:
    return points @ T[:3, :3].T + T[:3, 3]


def _described(path: Path, wanted: Wanted, visual: Mesh, parts: tuple[Mesh, ...]) -> ObjectDescription:
    return ObjectDescription(
        name=wanted.name,
        title=wanted.title or wanted.name.replace("_", " ").capitalize(),
        mass_kg=wanted.mass_kg,
        convex_parts=parts,
        visual=visual,
        color_rgb=wanted.color_rgb,
        lateral_friction=wanted.friction,
        source=f"Its owner's mesh {path.name}, {wanted.scale:g} m per unit",
    )


def _no_hand(name: str, body: Mesh) -> str:
    x, y, z = (100 * np.ptp(body.vertices, axis=0)).tolist()
    openings = ", ".join(f"{robot} opens {100 * ROBOTS[robot].gripper.opening_m:.3g} cm" for robot in ROBOTS)
    return (
        f"No hand can hold {name} ({x:.3g} x {y:.3g} x {z:.3g} cm): nowhere do two of its sides face each other at "
        f"least 1 cm apart and less than a hand's opening ({openings}). Another --scale may help."
    )
