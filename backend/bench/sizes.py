"""How much is measured: all of it, or so little that a test can wait for it."""

from __future__ import annotations

from dataclasses import dataclass

SCENARIOS = ("ur5_linear_obstacles", "ur5_linear_slab", "mico_linear_obstacles", "mico_linear_slab")


@dataclass(frozen=True)
class Size:
    """Counts; none of them is time."""

    trials: int
    """Of each scenario."""
    timeout_s: float | None
    """Simulated seconds after which a trial is cut off; None: the scenario's own."""
    problems: int
    """Planning problems per scenario that no straight edge solves."""
    random_ends: int
    """Planning problems per scenario between random free postures."""
    velocities: int
    """Starts at random velocities per scenario."""
    poses: int
    """IK targets per arm."""
    postures: int
    """Compared with the truth, over all scenarios."""
    path_postures: int
    """The same, along planned paths."""


FULL = Size(6, None, 80, 60, 400, 10_000, 10_000, 10_000)
QUICK = Size(1, 2.0, 2, 2, 10, 100, 60, 60)
