"""Units: SI inside, centimetres and degrees on the screen. The unit of a setting is the end of its name."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees


@dataclass(frozen=True)
class Unit:
    """How a figure is shown."""

    symbol: str
    """Empty for a pure number."""
    per_si: float = 1.0
    """Shown figure for 1 in SI."""

    def shown(self, si: float) -> float:
        """On the screen, without the dust of floating point."""
        return float(f"{self.per_si * si:.6g}")

    def si(self, shown: float) -> float:
        """Inside."""
        return shown / self.per_si


PURE = Unit("")
SUFFIXES: dict[str, Unit] = {
    "mps2": Unit("cm/s²", 100.0),
    "mps": Unit("cm/s", 100.0),
    "rad": Unit("°", degrees(1.0)),
    "hz": Unit("Hz"),
    "m": Unit("cm", 100.0),
    "s": Unit("s"),
}


def split_unit(name: str) -> tuple[str, Unit]:
    """The name without its unit, and the unit: ``speed_mps`` -> ``speed``, cm/s."""
    stem, _, suffix = name.rpartition("_")
    return (stem, SUFFIXES[suffix]) if stem and suffix in SUFFIXES else (name, PURE)
