"""Conditions: how one trial begins, as plain numbers that a table can hold."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from backend.motions import CircularMotion, LinearMotion, Motion, SinusoidalMotion
from backend.objects import load_object
from backend.pose import Pose
from backend.snapshot import BoxPlacement
from backend.tasks.setup import TrialSetup, tray_size_m

Numbers = dict[str, float]
OBSTACLES = 5
"""As many as a row has columns for."""
OBJECT = ("object_x_m", "object_y_m", "object_z_m", "object_yaw_rad")
"""Middle of the object's bottom, and its heading, in the world."""
SPEEDS = ("start_speed_mps", "end_speed_mps")
END = ("belt_end_x_m", "belt_end_y_m", "belt_end_z_m")
"""Where the object would be carried; the belt begins below the object."""
SWING = ("amplitude_m", "period_m")
CIRCLE = ("circle_x_m", "circle_y_m", "direction", "arc_m")
SLAB = ("slab_x_m", "slab_y_m", "slab_z_m", "slab_yaw_rad", "slab_length_m", "slab_width_m", "slab_thickness_m")
MOTION_COLUMNS = {
    "linear": (*END, *SPEEDS),
    "sinusoidal": (*END, *SPEEDS, *SWING),
    "circular": (*CIRCLE, *SPEEDS),
}


@dataclass(frozen=True)
class Conditions:
    """One row of a trial set."""

    robot: str
    task: str
    object: str
    seed: int
    """Of the sensor's noise and the planner's chance."""
    numbers: Numbers
    """Those columns that the task has; SI units."""
    obstacles: tuple[str, ...] = field(default=())
    """Object names; their places are in ``numbers``."""


def motion_kind(task: str) -> str:
    """Which motion the belt of a task makes."""
    return task if task in ("circular", "sinusoidal") else "linear"


def needed(task: str, obstacles: int) -> tuple[str, ...]:
    """The columns of numbers that a row of this task has."""
    slab = SLAB if task == "linear_slab" else ()
    places = tuple(name for i in range(obstacles) for name in place_columns(i))
    return (*OBJECT, *MOTION_COLUMNS[motion_kind(task)], *slab, *places)


def place_columns(index: int) -> tuple[str, str, str]:
    """Where obstacle ``index``, counted from 0, stands on the floor."""
    lead = f"obstacle_{index + 1}"
    return f"{lead}_x_m", f"{lead}_y_m", f"{lead}_yaw_rad"


def conditions_of(robot: str, task: str, object: str, seed: int, setup: TrialSetup) -> Conditions:
    """A setup as numbers."""
    T_world_object = setup.motion.pose_at(0.0) @ setup.T_tray_object
    numbers = _pose_numbers(OBJECT, T_world_object) | _motion_numbers(setup.motion)
    if setup.slab is not None:
        numbers |= _pose_numbers(SLAB[:4], setup.slab.T_world_box)
        numbers |= dict(zip(SLAB[4:], setup.slab.size_m, strict=True))
    for i, (_, pose) in enumerate(setup.obstacles):
        x, y, _ = pose.xyz_m.tolist()
        numbers |= dict(zip(place_columns(i), (x, y, pose.yaw_rad), strict=True))
    return Conditions(robot, task, object, seed, numbers, tuple(name for name, _ in setup.obstacles))


def setup_of(conditions: Conditions) -> TrialSetup:
    """Numbers as a setup, up to rounding the one that they were made from; raises ``ValueError`` for an odd motion."""
    n = conditions.numbers
    motion = _motion(conditions)
    turned = n["object_yaw_rad"] - motion.yaw_rad
    yaw_rad = math.pi - (math.pi - turned) % (2.0 * math.pi)
    return TrialSetup(
        motion=motion,
        object_yaw_rad=yaw_rad,
        tray_size_m=tray_size_m(load_object(conditions.object), yaw_rad),
        obstacles=tuple(
            (name, Pose.from_xyz_yaw((*_take(n, place_columns(i)[:2]), 0.0), n[place_columns(i)[2]]))
            for i, name in enumerate(conditions.obstacles)
        ),
        slab=_slab(n) if conditions.task == "linear_slab" else None,
    )


def _slab(n: Numbers) -> BoxPlacement:
    length_m, width_m, thickness_m = _take(n, SLAB[4:])
    return BoxPlacement(Pose.from_xyz_yaw(_take(n, SLAB[:3]), n["slab_yaw_rad"]), (length_m, width_m, thickness_m))


def _motion(conditions: Conditions) -> Motion:
    n = conditions.numbers
    x, y, z = _take(n, OBJECT[:3])
    kind = motion_kind(conditions.task)
    if kind == "circular":
        dx, dy = x - n["circle_x_m"], y - n["circle_y_m"]
        direction: Literal[1, -1] = 1 if n["direction"] > 0 else -1
        return CircularMotion(
            center_m=(n["circle_x_m"], n["circle_y_m"], z),
            radius_m=math.hypot(dx, dy),
            start_angle_rad=math.atan2(dy, dx),
            direction=direction,
            length_m=n["arc_m"],
            speed_mps=n["start_speed_mps"],
        )
    start, end = (x, y, z), (n["belt_end_x_m"], n["belt_end_y_m"], n["belt_end_z_m"])
    if kind == "sinusoidal":
        amplitude_m, period_m = _take(n, SWING)
        speed_mps = n["start_speed_mps"]
        return SinusoidalMotion(
            start_m=start, end_m=end, speed_mps=speed_mps, amplitude_m=amplitude_m, period_m=period_m
        )
    start_mps, end_mps = _take(n, SPEEDS)
    return LinearMotion(start_m=start, end_m=end, start_speed_mps=start_mps, end_speed_mps=end_mps)


def _motion_numbers(motion: Motion) -> Numbers:
    match motion:
        case LinearMotion():
            speeds = (motion.start_speed_mps, motion.end_speed_mps)
            return dict(zip((*END, *SPEEDS), (*motion.end_m, *speeds), strict=True))
        case SinusoidalMotion():
            rest = (motion.speed_mps, motion.speed_mps, motion.amplitude_m, motion.period_m)
            return dict(zip((*END, *SPEEDS, *SWING), (*motion.end_m, *rest), strict=True))
        case CircularMotion():
            circle = (*motion.center_m[:2], float(motion.direction), motion.length_m)
            return dict(zip((*CIRCLE, *SPEEDS), (*circle, motion.speed_mps, motion.speed_mps), strict=True))


def _pose_numbers(names: Sequence[str], pose: Pose) -> Numbers:
    return dict(zip(names, (*pose.xyz_m.tolist(), pose.yaw_rad), strict=True))


def _take(n: Numbers, names: Sequence[str]) -> tuple[float, ...]:
    return tuple(n[name] for name in names)
