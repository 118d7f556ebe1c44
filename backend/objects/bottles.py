"""The two bottles: bleach cleanser and mustard."""

from backend.objects.description import ObjectDescription
from backend.objects.loft import convex_bands, loft, sections_mm
from backend.objects.ycb import YCB_SOURCE

MUSTARD_SECTIONS = sections_mm(
    (0, 39.4, 24.5, 1.4),
    (4, 45.1, 28.1, 2.4),
    (20, 47.8, 28.3, 2.4),
    (40, 46.2, 26.0, 2.6),
    (60, 40.8, 25.1, 3.0),
    (80, 40.8, 25.0, 3.0),
    (100, 47.2, 25.2, 2.4),
    (115, 47.7, 25.2, 2.3),
    (125, 45.7, 25.5, 2.4),
    (135, 40.8, 26.0, 2.6),
    (145, 32.0, 28.4, 2.2),
    (152, 24.8, 24.8, 2),
    (165, 20.2, 20.4, 2),
    (172, 13.0, 13.3, 2),
    (180, 11.0, 11.1, 2),
    (188, 9.4, 9.5, 2),
    (191, 6.0, 6.0, 2),
)
"""The last row rounds the nozzle off at the scan's height; the others are measured."""

BLEACH_SECTIONS = sections_mm(
    (0, 46.1, 30.2, 3.4, -2.0),
    (5, 48.9, 33.2, 3.4, -2.1),
    (30, 47.4, 32.4, 2.9, 1.2),
    (60, 47.6, 30.7, 2.9, 2.4),
    (90, 46.9, 28.9, 2.9, 3.9),
    (120, 45.4, 27.1, 2.9, 5.8),
    (150, 42.4, 25.2, 2.9, 8.0),
    (170, 38.2, 24.3, 2.7, 10.8),
    (185, 35.2, 27.1, 2.4, 13.4),
    (195, 35.1, 26.3, 2.3, 14.4),
    (205, 35.4, 25.6, 2.2, 10.9),
    (212, 34.9, 25.0, 2.1, 8.7),
    (225, 21.2, 18.7, 2, 10.0),
    (238, 15.3, 15.3, 2, 9.0),
    (244, 13.4, 11.3, 1.9, 6.9),
    (249, 14.1, 12.4, 1.8, 8.1),
)


def mustard_bottle() -> ObjectDescription:
    """A squeezed-waist bottle with a nozzle; the waist is its own convex band."""
    return ObjectDescription(
        name="mustard_bottle",
        title="Mustard bottle",
        mass_kg=0.603,
        convex_parts=convex_bands(MUSTARD_SECTIONS, (0.060, 0.080, 0.152, 0.172)),
        visual=loft(MUSTARD_SECTIONS),
        color_rgb=(240, 190, 20),
        source=YCB_SOURCE,
    )


def bleach_cleanser() -> ObjectDescription:
    """A tall bottle that leans towards its cap."""
    return ObjectDescription(
        name="bleach_cleanser",
        title="Bleach cleanser",
        mass_kg=1.131,
        convex_parts=convex_bands(BLEACH_SECTIONS, (0.170, 0.195, 0.225)),
        visual=loft(BLEACH_SECTIONS),
        color_rgb=(222, 232, 240),
        source=YCB_SOURCE,
    )
