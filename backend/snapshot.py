"""Snapshot: all that an observer of an episode may see at one tick, immutable."""

from __future__ import annotations

from dataclasses import dataclass

from backend.pipeline.values import CycleResult, Outcome, Phase
from backend.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class BoxPlacement:
    """An axis-aligned box in its own frame."""

    T_world_box: Pose
    size_m: tuple[float, float, float]

    def same(self, other: BoxPlacement | None) -> bool:
        """Whether it is as large and where ``other`` is."""
        if other is None or self.size_m != other.size_m:
            return False
        return bool((self.T_world_box.matrix == other.T_world_box.matrix).all())


@dataclass(frozen=True, eq=False)
class SceneDescription:
    """What does not move during an episode: enough to draw the scene once."""

    robot: str
    object: str
    tray_size_m: tuple[float, float, float]
    """The tray's frame is the middle of its top face."""
    belt_path_world: Array
    """(n, 3) the way of the middle of the tray's top face."""
    obstacles: tuple[str, ...]
    """Object names, as the trial begins."""
    slab: BoxPlacement | None
    """The same: people may take it away or hang another."""
    seed: int


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One tick."""

    tick: int
    t_s: float
    phase: Phase
    q: Array
    """(dof,) rad."""
    joints_rad: dict[str, float]
    """Every movable joint of arm and hand by name, for drawing."""
    T_world_tcp: Pose
    T_world_tray: Pose
    T_world_object: Pose
    obstacles: tuple[str, ...]
    """Object names of what stands around now."""
    Ts_world_obstacle: Array
    """(n, 4, 4), in that order."""
    slab: BoxPlacement | None
    """What hangs above the belt now."""
    belt_rate: float
    """Live factor on the belt's speed; 1 as in the scenario, negative backwards."""
    cycle: CycleResult | None
    """The newest cycle; None before the first."""
    cycles: int
    outcome: Outcome | None
    """Set on the last snapshot of an episode."""
    grip_n: float = 0.0
    """Sum of the normal forces with which the hand's links press on the object, from the moment it begins to close."""
    fingerprint: str | None = None
    """Hash of the whole trial, set on the last snapshot: equal for equal trials, live or headless."""

    def stands_as(self, other: Snapshot) -> bool:
        """Whether the same obstacles stand around, wherever, and the same slab hangs in the same place."""
        alike = other.slab is None if self.slab is None else self.slab.same(other.slab)
        return alike and self.obstacles == other.obstacles
