"""Start: how one trial begins, as plain numbers and names that a table or a scenario file can hold.

Columns are in SI units and the world frame; which of them a start has depends on its task.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

from pydantic import ValidationError

from backend.motions import CircularMotion, LinearMotion, Motion, SinusoidalMotion
from backend.objects import load_object, object_names
from backend.pose import Pose
from backend.snapshot import BoxPlacement
from backend.tasks.ranges import complaint_of
from backend.tasks.setup import TrialSetup, tray_size_m

Start = dict[str, float | str]
"""Column -> number, or the name of an object that stands in the way."""
Numbers = dict[str, float]
Complaint = tuple[str, str]
"""Column, and what is wrong there."""

OBSTACLES = 5
"""As many as there are columns for."""
OBSTACLE_NAMES = tuple(f"obstacle_{i + 1}" for i in range(OBSTACLES))
SHORTEST_M = 0.05
"""Of belts and radii."""
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


def motion_kind(task: str) -> str:
    """Which motion the belt of a task makes."""
    return task if task in ("circular", "sinusoidal") else "linear"


def needed(task: str, obstacles: int) -> tuple[str, ...]:
    """The columns of numbers that a start of this task has."""
    slab = SLAB if task == "linear_slab" else ()
    places = tuple(name for i in range(obstacles) for name in place_columns(i))
    return (*OBJECT, *MOTION_COLUMNS[motion_kind(task)], *slab, *places)


def place_columns(index: int) -> tuple[str, str, str]:
    """Where obstacle ``index``, counted from 0, stands on the floor."""
    lead = OBSTACLE_NAMES[index]
    return f"{lead}_x_m", f"{lead}_y_m", f"{lead}_yaw_rad"


def start_of(setup: TrialSetup) -> Start:
    """A setup as columns."""
    T_world_object = setup.motion.pose_at(0.0) @ setup.T_tray_object
    numbers = _pose_numbers(OBJECT, T_world_object) | _motion_numbers(setup.motion)
    if setup.slab is not None:
        numbers |= _pose_numbers(SLAB[:4], setup.slab.T_world_box)
        numbers |= dict(zip(SLAB[4:], setup.slab.size_m, strict=True))
    for i, (_, pose) in enumerate(setup.obstacles):
        x, y, _ = pose.xyz_m.tolist()
        numbers |= dict(zip(place_columns(i), (x, y, pose.yaw_rad), strict=True))
    names = zip(OBSTACLE_NAMES, (name for name, _ in setup.obstacles), strict=False)
    return {**numbers, **dict(names)}


def setup_of(start: Start, task: str, object: str) -> TrialSetup:
    """Columns in which nothing is wrong as a setup, up to rounding the one that they were made from."""
    n = {column: value for column, value in start.items() if isinstance(value, float)}
    motion = _motion(n, task)
    turned = n["object_yaw_rad"] - motion.yaw_rad
    yaw_rad = math.pi - (math.pi - turned) % (2.0 * math.pi)
    return TrialSetup(
        motion=motion,
        object_yaw_rad=yaw_rad,
        tray_size_m=tray_size_m(load_object(object), yaw_rad),
        obstacles=tuple(
            (name, Pose.from_xyz_yaw((*_take(n, place_columns(i)[:2]), 0.0), n[place_columns(i)[2]]))
            for i, name in enumerate(_obstacles(start))
        ),
        slab=_slab(n) if task == "linear_slab" else None,
    )


def read_start(task: str, cells: Mapping[str, float | str]) -> tuple[Start, list[Complaint]]:
    """The start that columns of numbers or text say, and all that is wrong with them; empty cells are not there."""
    said = {column: text for column, value in cells.items() if (text := str(value).strip())}
    names = [said[column] for column in OBSTACLE_NAMES if column in said]
    there = object_names()
    wrong: list[Complaint] = [
        (column, f"there is no object {said[column]!r}; there are {', '.join(there)}")
        for column in OBSTACLE_NAMES
        if column in said and said[column] not in there
    ]
    start: Start = dict(zip(OBSTACLE_NAMES, names, strict=False))
    columns = needed(task, len(names))
    for column in columns:
        complaint = complaint_of(column, said.get(column, ""))
        if complaint is None:
            start[column] = float(said[column])
        else:
            wrong.append((column, complaint))
    fitting = (*columns, *OBSTACLE_NAMES)
    wrong += [(column, f"the task {task} has none") for column in said if column not in fitting]
    return start, wrong or _odd_motion(task, start)


def _odd_motion(task: str, start: Start) -> list[Complaint]:
    """What is wrong with the belt that the numbers, each fine by itself, make together."""
    n = {column: value for column, value in start.items() if isinstance(value, float)}
    other = CIRCLE[:2] if task == "circular" else END[:2]
    length_m = math.dist([n[name] for name in OBJECT[:2]], [n[name] for name in other])
    if length_m < SHORTEST_M:
        what = "circle's radius is" if task == "circular" else "belt is"
        return [(", ".join(other), f"the {what} only {length_m:g} m; metres are wanted")]
    try:
        _motion(n, task)
    except ValidationError as error:
        return [(", ".join((*OBJECT, *other)), error.errors()[0]["msg"])]
    return []


def _obstacles(start: Start) -> list[str]:
    return [str(start[column]) for column in OBSTACLE_NAMES if column in start]


def _slab(n: Numbers) -> BoxPlacement:
    length_m, width_m, thickness_m = _take(n, SLAB[4:])
    return BoxPlacement(Pose.from_xyz_yaw(_take(n, SLAB[:3]), n["slab_yaw_rad"]), (length_m, width_m, thickness_m))


def _motion(n: Numbers, task: str) -> Motion:
    x, y, z = _take(n, OBJECT[:3])
    kind = motion_kind(task)
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
