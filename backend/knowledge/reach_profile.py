"""ReachProfile: the field of reach seen around the base's axis: its best grasp of a kind at each radius and height."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Literal, Protocol, get_args

import numpy as np

from backend.pose import Array

GraspKind = Literal["From above", "From the side"]
GRASP_KINDS: tuple[GraspKind, ...] = get_args(GraspKind)
STEP_M = 0.04
RADIUS_M = 1.2
HIGHEST_M = 0.88
"""As high as the fields go."""
TURNS = 8
"""Of the hand about its approach, and of a level approach about the vertical."""


class Field(Protocol):
    """What ``ReachabilityField`` answers."""

    def signed_distance(self, Ts_world_tcp: Array) -> Array: ...


@dataclass(frozen=True, eq=False)
class ReachProfile:
    """Signed distance in metres, positive where some grasp of that kind is in reach. The base counts as round."""

    radius_m: Array
    """(n,) from the base's axis."""
    height_m: Array
    """(m,) of the tcp above the floor."""
    distance_m: Array
    """(kinds, m, n), in the order of ``GRASP_KINDS``."""

    def at(self, kind: GraspKind, height_m: float) -> Array:
        """(n,) at one height, between the two rows next to it."""
        rows = self.distance_m[GRASP_KINDS.index(kind)]
        place = float(np.interp(height_m, self.height_m, np.arange(len(rows))))
        low = min(int(place), len(rows) - 2)
        share = place - low
        return (1.0 - share) * rows[low] + share * rows[low + 1]


def profile_of(field: Field) -> ReachProfile:
    """The best over ``TURNS`` of the hand, and for level approaches over as many directions."""
    radius_m = np.arange(0.0, RADIUS_M + STEP_M / 2, STEP_M)
    height_m = np.arange(0.0, HIGHEST_M + STEP_M / 2, STEP_M)
    places = np.array([(rho, 0.0, z) for z in height_m for rho in radius_m])
    rotations = _downward(), _level()
    best = [np.max([_distances(field, R, places) for R in kind], axis=0) for kind in rotations]
    return ReachProfile(radius_m, height_m, np.reshape(best, (2, len(height_m), len(radius_m))))


def _distances(field: Field, rotation: Array, places: Array) -> Array:
    Ts = np.tile(np.eye(4), (len(places), 1, 1))
    Ts[:, :3, :3], Ts[:, :3, 3] = rotation, places
    return field.signed_distance(Ts)


def _downward() -> list[Array]:
    return [_hand(np.array([0.0, 0.0, -1.0]), np.array([np.cos(a), np.sin(a), 0.0])) for a in _turns()]


def _level() -> list[Array]:
    out: list[Array] = []
    for about, roll in itertools.product(_turns(), _turns()):
        approach = np.array([np.cos(about), np.sin(about), 0.0])
        across = np.array([-np.sin(about), np.cos(about), 0.0])
        out.append(_hand(approach, np.cos(roll) * across + np.sin(roll) * np.array([0.0, 0.0, 1.0])))
    return out


def _hand(z_axis: Array, x_axis: Array) -> Array:
    """(3, 3) of a tcp frame with that approach (z) and that x."""
    return np.column_stack([x_axis, np.cross(z_axis, x_axis), z_axis])


def _turns() -> Array:
    return np.arange(TURNS) * 2.0 * np.pi / TURNS
