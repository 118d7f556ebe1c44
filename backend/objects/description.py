"""What an object is: its shape, convex parts, mass and friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backend.objects.mesh import Mesh
from backend.objects.outline import convex_outline
from backend.pose import Array


@dataclass(frozen=True, eq=False)
class ObjectDescription:
    """A rigid body. Its frame: z up as it rests, origin at its bottom, in the middle of its footprint."""

    name: str
    title: str
    mass_kg: float
    convex_parts: tuple[Mesh, ...]
    """Convex, watertight, in the object frame; their union is the shape that physics and planners see."""
    visual: Mesh
    """Watertight mesh in the object frame: what is drawn, and what grasps are sampled on."""
    color_rgb: tuple[int, int, int]
    lateral_friction: float = 0.7
    spinning_friction: float = 0.002
    source: str = ""
    """Where the measurements come from."""

    @property
    def center_of_mass_m(self) -> Array:
        """(3,) in the object frame, for uniform density."""
        return self.visual.center_of_mass_m

    @cached_property
    def inertia_kgm2(self) -> Array:
        """(3, 3) about the centre of mass, axes of the object frame, for uniform density."""
        return self.visual.inertia_m5 * (self.mass_kg / self.visual.volume_m3)

    @cached_property
    def footprint_m(self) -> Array:
        """(n, 2) counter-clockwise convex hull of the shape seen from above, in the object frame."""
        return convex_outline(np.concatenate([part.vertices[:, :2] for part in self.convex_parts]))

    @property
    def height_m(self) -> float:
        return float(self.visual.bounds_m[1, 2])


MakeObject = Callable[[], ObjectDescription]
