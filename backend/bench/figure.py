"""Figure: one measured number, beside what is wanted of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Sense = Literal["<=", ">="]


@dataclass(frozen=True)
class Figure:
    """A measured number, in the unit it is shown in."""

    part: str
    what: str
    measured: float
    unit: str = ""
    sense: Sense = "<="
    target: float | None = None
    """None: for information."""
    of: int = 0
    """How many cases it was measured on."""

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None where there is none. NaN meets nothing."""
        if self.target is None:
            return None
        return self.measured <= self.target if self.sense == "<=" else self.measured >= self.target

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        fields = {name: getattr(self, name) for name in ("part", "what", "unit", "of")}
        wanted = None if self.target is None else f"{self.sense} {self.target:g}"
        return {**fields, "measured": self.measured, "target": wanted, "met": self.met}

    def line(self) -> str:
        """For people."""
        wanted = "" if self.target is None else f"  wanted {self.sense} {self.target:g} {self.unit}"
        verdict = "" if self.met is None else "  met" if self.met else "  MISSED"
        return f"  {self.what:<64} {self.measured:>10.4g} {self.unit:<6} n = {self.of:<6}{wanted}{verdict}".rstrip()
