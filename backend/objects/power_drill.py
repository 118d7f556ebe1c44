"""The power drill, lying on its side: eight lofts whose axes lie in its plane of symmetry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.objects.description import ObjectDescription
from backend.objects.loft import Section, convex_hull, ring, sections_mm
from backend.objects.mesh import Mesh
from backend.objects.surface_nets import surface_of
from backend.objects.ycb import YCB_SOURCE
from backend.pose import Array

HALF_THICKNESS_M = 0.02865
CELL_M = 0.004


@dataclass(frozen=True)
class LyingLoft:
    """A loft along an axis that lies in the plane of symmetry.

    A section's ``z_m`` runs along the axis from its start, its x across the axis (to the left), its y along
    the vertical of the lying drill.
    """

    start_m: tuple[float, float]
    towards: tuple[float, float]
    """Direction of the axis in the plane; any length."""
    sections: tuple[Section, ...]

    @property
    def along(self) -> Array:
        return np.asarray(self.towards) / np.linalg.norm(self.towards)

    @property
    def left(self) -> Array:
        return np.array([-self.along[1], self.along[0]])

    def convex(self) -> Mesh:
        """The hull of its sections, in the object frame."""
        rings = np.concatenate([ring(section, 24) for section in self.sections])
        plane = np.asarray(self.start_m) + rings[:, [2]] * self.along + rings[:, [0]] * self.left
        return convex_hull(np.column_stack([plane, rings[:, 1] + HALF_THICKNESS_M]))

    def axes(self, plane: Array) -> tuple[Array, Array]:
        """Distances (n,) along the axis and (n,) to its left of points (n, 2) in the plane."""
        offset = plane - self.start_m
        return offset @ self.along, offset @ self.left

    def near(self, plane: Array, margin_m: float) -> NDArray[np.bool_]:
        """(n,) whether points (n, 2) in the plane lie in the part's rectangle, widened by the margin."""
        s, across = self.axes(plane)
        reach_m = max(abs(section.shift_m) + section.half_x_m for section in self.sections) + margin_m
        inside = (s > self.sections[0].z_m - margin_m) & (s < self.sections[-1].z_m + margin_m)
        return inside & (np.abs(across) < reach_m)

    def field(self, plane: Array, heights_m: Array) -> Array:
        """(n, m) roughly the signed distance in metres, exact at the surface, negative inside."""
        s, across = self.axes(plane)
        z = [section.z_m for section in self.sections]
        half_x, half_y, exponent, shift = (
            np.interp(s, z, [getattr(section, name) for section in self.sections])[:, None]
            for name in ("half_x_m", "half_y_m", "exponent", "shift_m")
        )
        up = np.abs(heights_m - HALF_THICKNESS_M) / half_y
        scaled = np.abs((across[:, None] - shift) / half_x) ** exponent + up**exponent
        side = (scaled ** (1 / exponent) - 1) * np.minimum(half_x, half_y)
        return np.maximum(side, np.maximum(z[0] - s, s - z[-1])[:, None])


MOTOR = LyingLoft(
    (-0.0921, 0.0652),
    (1, 0),
    sections_mm((0, 18, 19, 2.2), (6, 25, 26, 2.2), (45, 28.3, 28.65, 2.2), (112, 27.5, 28.65, 2.3)),
)
CLUTCH = LyingLoft((0.0199, 0.0652), (1, 0), sections_mm((0, 26, 26.5), (18, 25, 25), (28, 21, 21)))
CHUCK = LyingLoft((0.0479, 0.0652), (1, 0), sections_mm((0, 20, 20), (28, 19.5, 19.5), (44.2, 11, 11)))
UPPER_HANDLE = LyingLoft(
    (-0.033, 0.055), (-0.06, -1), sections_mm((0, 27, 22, 2.4), (30, 23, 20, 2.4), (62, 20.5, 18.5, 2.4))
)
LOWER_HANDLE = LyingLoft(
    (-0.0367, -0.0069),
    (-0.06, -1),
    sections_mm((0, 20.5, 18.5, 2.4), (30, 20.5, 18.5, 2.5), (50, 22, 20, 2.6)),
)
NECK = LyingLoft((-0.0397, -0.052), (0, -1), sections_mm((0, 23, 20.5, 2.6), (12, 42, 26, 3.5, 0), (14, 44, 27, 4, 0)))
FOOT = LyingLoft(
    (-0.0390, -0.0600),
    (0, -1),
    sections_mm((0, 42, 26.5, 5, 2), (5, 47, 28.65, 6, 3), (29, 47, 28.65, 6, 3), (33.5, 44, 26.5, 5, 3)),
)
TRIGGER = LyingLoft((-0.0085, 0.040), (-0.12, -1), sections_mm((0, 8, 9, 2.2), (16, 6.5, 8.5, 2.2), (28, 5, 7.5, 2.2)))

PARTS = (MOTOR, CLUTCH, CHUCK, UPPER_HANDLE, LOWER_HANDLE, NECK, FOOT, TRIGGER)


def power_drill() -> ObjectDescription:
    """A pistol drill as it lies on a belt: barrel along x, handle and battery foot towards -y."""
    convex_parts = tuple(part.convex() for part in PARTS)
    corners = np.concatenate([part.bounds_m for part in convex_parts])
    visual = surface_of(union_field, corners.min(axis=0), corners.max(axis=0), CELL_M)
    return ObjectDescription(
        name="power_drill",
        title="Power drill",
        mass_kg=0.895,
        convex_parts=convex_parts,
        visual=visual,
        color_rgb=(236, 108, 36),
        source=YCB_SOURCE,
    )


def union_field(plane: Array, heights_m: Array) -> Array:
    """(n, m) negative inside any part; far from every part only its sign is right."""
    union = np.full((len(plane), len(heights_m)), 1.0)
    for part in PARTS:
        near = part.near(plane, margin_m=2 * CELL_M)
        union[near] = np.minimum(union[near], part.field(plane[near], heights_m))
    return union
