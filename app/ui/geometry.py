"""Shapes that layers draw: those of films too, and the small hand that stands for a grasp."""

from __future__ import annotations

from backend.looks import Geometry, box, chevrons, creased, joined, ribbon, ring, segments, thinned

__all__ = ["Geometry", "box", "chevrons", "creased", "gripper_glyph", "joined", "ribbon", "ring", "segments", "thinned"]


def gripper_glyph(opening_m: float) -> Geometry:
    """A two-finger hand in the tcp frame: fingers close along y, z points at the object."""
    bar, finger_m, stem_m = 0.007, 0.05, 0.045
    half = opening_m / 2 + bar / 2
    return joined(
        box((bar, bar, finger_m), (0.0, half, 0.01 - finger_m / 2)),
        box((bar, bar, finger_m), (0.0, -half, 0.01 - finger_m / 2)),
        box((bar, opening_m + 2 * bar, bar), (0.0, 0.0, 0.01 - finger_m)),
        box((bar, bar, stem_m), (0.0, 0.0, 0.01 - finger_m - stem_m / 2)),
    )
