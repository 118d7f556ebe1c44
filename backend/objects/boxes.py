"""The two boxes: sugar and the 5 cm cube."""

import numpy as np

from backend.objects.description import ObjectDescription
from backend.objects.loft import convex_hull
from backend.objects.mesh import Mesh
from backend.objects.ycb import YCB_SOURCE


def sugar_box() -> ObjectDescription:
    """A standing carton; the box that fits the (skewed) scan best, long side along x."""
    box = upright_box((0.0895, 0.0395, 0.1755))
    return ObjectDescription(
        name="sugar_box",
        title="Sugar box",
        mass_kg=0.514,
        convex_parts=(box,),
        visual=box,
        color_rgb=(208, 168, 122),
        source=YCB_SOURCE,
    )


def cube() -> ObjectDescription:
    """The 5 cm cube of the paper; its mass is chosen as that of hard plastic or wood."""
    box = upright_box((0.05, 0.05, 0.05))
    return ObjectDescription(
        name="cube",
        title="Cube (5 cm)",
        mass_kg=0.125,
        convex_parts=(box,),
        visual=box,
        color_rgb=(132, 92, 196),
        source="A 5 cm cube of 1 g/cm^3",
    )


def upright_box(size_m: tuple[float, float, float]) -> Mesh:
    """Box standing on the origin."""
    signs = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
    return convex_hull(signs * size_m)
