"""The two tins: tomato soup and potted meat."""

from backend.objects.description import ObjectDescription
from backend.objects.loft import convex_bands, loft, sections_mm
from backend.objects.ycb import YCB_SOURCE

SOUP_SECTIONS = sections_mm((0, 33.2, 33.2), (0.8, 33.8, 33.8), (101.1, 33.8, 33.8), (101.9, 33.2, 33.2))
"""The fitted cylinder of radius 33.8 mm, its rims broken by 0.7 mm."""

POTTED_MEAT_SECTIONS = sections_mm(
    (0, 47.4, 25.8, 1.4),
    (3, 48.0, 26.2, 3.4),
    (40, 48.1, 25.8, 3.7),
    (80, 49.9, 28.1, 4.2),
    (83, 50.7, 28.5, 4.3),
)


def tomato_soup_can() -> ObjectDescription:
    """An upright cylinder."""
    return ObjectDescription(
        name="tomato_soup_can",
        title="Tomato soup can",
        mass_kg=0.349,
        convex_parts=convex_bands(SOUP_SECTIONS),
        visual=loft(SOUP_SECTIONS),
        color_rgb=(200, 44, 44),
        source=YCB_SOURCE,
    )


def potted_meat_can() -> ObjectDescription:
    """A low tin with rounded corners, slightly wider at its lid."""
    return ObjectDescription(
        name="potted_meat_can",
        title="Potted meat can",
        mass_kg=0.370,
        convex_parts=convex_bands(POTTED_MEAT_SECTIONS),
        visual=loft(POTTED_MEAT_SECTIONS),
        color_rgb=(50, 96, 176),
        source=YCB_SOURCE,
    )
