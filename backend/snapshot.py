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
    """Object names, in the order of ``Snapshot.Ts_world_obstacle``."""
    slab: BoxPlacement | None
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
    Ts_world_obstacle: Array
    """(n, 4, 4)."""
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
