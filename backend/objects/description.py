"""What an object is: its shape, convex parts, mass and friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh

from backend.pose import Array


@dataclass(frozen=True, eq=False)
class ObjectDescription:
    """A rigid body. Its frame: z up as it rests, origin at its bottom, in the middle of its footprint."""

    name: str
    title: str
    mass_kg: float
    convex_parts: tuple[trimesh.Trimesh, ...]
    """Convex, watertight, in the object frame; their union is the shape that physics and planners see."""
    visual: trimesh.Trimesh
    """Watertight mesh in the object frame: what is drawn, and what grasps are sampled on."""
    color_rgb: tuple[int, int, int]
    lateral_friction: float = 0.7
    spinning_friction: float = 0.002
    source: str = ""
    """Where the measurements come from."""

    @cached_property
    def center_of_mass_m(self) -> Array:
        """(3,) in the object frame, for uniform density."""
        return np.asarray(self.visual.center_mass, dtype=np.float64)

    @cached_property
    def inertia_kgm2(self) -> Array:
        """(3, 3) about the centre of mass, axes of the object frame, for uniform density."""
        return np.asarray(self.visual.moment_inertia, dtype=np.float64) * (self.mass_kg / self.visual.volume)

    @cached_property
    def footprint_m(self) -> Array:
        """(n, 2) counter-clockwise convex hull of the shape seen from above, in the object frame."""
        from scipy.spatial import ConvexHull

        points = np.concatenate([part.vertices[:, :2] for part in self.convex_parts])
        return points[ConvexHull(points).vertices]

    @property
    def height_m(self) -> float:
        return float(self.visual.bounds[1, 2])


MakeObject = Callable[[], ObjectDescription]
