"""How a body comes to rest on a plane, likeliest first, and whether it stays so in simulation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import trimesh

from backend.objects.description import ObjectDescription
from backend.objects.mesh import Mesh
from backend.pose import Array, Pose, rotation_angle_rad
from backend.sim.bullet import STEP_S, Bullet

ALIKE = float(np.cos(np.radians(8.0)))
"""Cosine of the angle within which two poses count as one: the facets of a scanned base differ by less."""
STANDING_S, MOVED_M, TURNED_RAD = 1.0, 0.003, float(np.radians(2.0))
NUDGE_RAD = float(np.radians(5.0))


@dataclass(frozen=True, eq=False)
class Rest:
    """One way to lie."""

    up: Array
    """(3,) what points up, in the frame of the file."""
    probability: float
    """Share of random quasi-static drops that end so."""

    @property
    def rotation(self) -> Array:
        """(3, 3) R_object_file: the smallest turn that brings ``up`` upwards, so that what was straight stays so."""
        across, cosine = np.array([self.up[1], -self.up[0], 0.0]), float(self.up[2])
        if np.linalg.norm(across) < 1e-9:
            return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
        x, y, z = across
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        return np.eye(3) + cross + cross @ cross / (1.0 + cosine)


def rests(body: Mesh, seed: int) -> list[Rest]:
    """Every stable way to lie, likeliest first (Goldberg et al., Part pose statistics, IJRR 18, 1999)."""
    found: Any = cast(Any, trimesh.poses).compute_stable_poses(
        body.as_trimesh().convex_hull, center_mass=body.center_of_mass_m, seed=seed
    )
    grouped: list[Rest] = []
    for T, probability in zip(np.asarray(found[0]), np.asarray(found[1]).tolist(), strict=True):
        up = np.asarray(T[2, :3], dtype=np.float64)
        same = next((i for i, rest in enumerate(grouped) if rest.up @ up > ALIKE), None)
        if same is None:
            grouped.append(Rest(up, probability))
        else:
            grouped[same] = replace(grouped[same], probability=grouped[same].probability + probability)
    return sorted(grouped, key=lambda rest: -rest.probability)


def is_upright(rest: Rest) -> bool:
    """Whether the file's z points up."""
    return bool(rest.up[2] > ALIKE)


def stands(described: ObjectDescription) -> bool:
    """Whether the object stays where it is put down on a floor."""
    end = _settled(described, Pose.identity())
    moved_m = float(np.linalg.norm(end.xyz_m))
    return moved_m < MOVED_M and rotation_angle_rad(np.eye(3), end.rotation) < TURNED_RAD


def is_steady(described: ObjectDescription) -> bool:
    """Whether it comes back when it is put down tilted a little, as it may be on a belt: a ball would roll away."""
    for roll, pitch in ((NUDGE_RAD, 0.0), (-NUDGE_RAD, 0.0), (0.0, NUDGE_RAD), (0.0, -NUDGE_RAD)):
        tilted = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (roll, pitch, 0.0))
        lowest_m = min(float(tilted.transform_points(part.vertices)[:, 2].min()) for part in described.convex_parts)
        end = _settled(described, Pose.of((0.0, 0.0, -lowest_m)) @ tilted)
        if end.rotation[2, 2] < np.cos(TURNED_RAD):
            return False
    return True


def _settled(described: ObjectDescription, T_world_object: Pose) -> Pose:
    """Where an object is, a second after it has been put down."""
    with Bullet() as bullet:
        bullet.add_floor()
        body = bullet.add_object(described, T_world_object)
        bullet.step(round(STANDING_S / STEP_S))
        return bullet.pose(body)
