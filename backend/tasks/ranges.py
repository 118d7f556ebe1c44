"""Ranges: what a number of a start may be, and which unit was probably meant by one that is not."""

from __future__ import annotations

import math

PLACE_M = (-3.0, 3.0)
HEIGHT_M = (0.005, 1.5)
LENGTH_M = (0.01, 5.0)
SPEED_MPS = (0.001, 0.5)
ANGLE_RAD = (-2.0 * math.pi, 2.0 * math.pi)
METRES = {"millimetres": 1e-3, "centimetres": 1e-2, "kilometres": 1e3}
MPS = {"mm/s": 1e-3, "cm/s": 1e-2, "km/s": 1e3}


def complaint_of(column: str, text: str) -> str | None:
    """What is wrong with a number of this column; None when it can be used."""
    try:
        value = float(text)
    except ValueError:
        return "a number is missing" if not text else f"{text!r} is not a number"
    if column == "direction":
        return None if value in (1.0, -1.0) else f"{text} is neither 1 (counter-clockwise) nor -1"
    low, high = bounds(column)
    if low <= value <= high:
        return None
    return f"{text} is not from {low:g} to {high:g}{_hint(column, value, low, high)}"


def bounds(column: str) -> tuple[float, float]:
    """Least and largest value of a column."""
    if column.endswith("_rad"):
        return ANGLE_RAD
    if column.endswith("_mps"):
        return SPEED_MPS
    if column.endswith("_z_m"):
        return HEIGHT_M
    if column.endswith(("_x_m", "_y_m")):
        return PLACE_M
    return (0.0, LENGTH_M[1]) if column == "amplitude_m" else LENGTH_M


def _hint(column: str, value: float, low: float, high: float) -> str:
    """Another unit in which the value would make sense."""
    if column.endswith("_rad"):
        return "; radians are wanted, this looks like degrees" if abs(value) <= 360.0 else ""
    unit, units = ("m/s", MPS) if column.endswith("_mps") else ("metres", METRES)
    fitting = [name for name, factor in units.items() if low <= value * factor <= high]
    return f"; {unit} are wanted, this looks like {' or '.join(fitting)}" if fitting else ""
