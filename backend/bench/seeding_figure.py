"""Seeded and unseeded plans of one trial, drawn side by side."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from backend.bench.course import Course
from backend.kinematics import load_kinematics
from backend.pose import Array

STEP_RAD = 0.05


def draw_seeding(courses: Sequence[tuple[str, Course]], folder: Path) -> Path:
    """Write ``seeding.png`` into ``folder``: where the hand goes by every plan of a trial, and where it went."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.5 * len(courses), 7.0), layout="constrained")
    axes = figure.subplots(2, len(courses), sharex="row", sharey="row", squeeze=False)
    image = None
    for column, (title, course) in enumerate(courses):
        for ax, (across, up) in zip(axes[:, column], ((1, 0), (1, 2)), strict=True):
            image = _draw(ax, course, across, up)
            ax.set(xlabel="y (m)", ylabel=f"{'xyz'[up]} (m)", aspect="equal")
        axes[0, column].set_title(f"{title}: {len(_plans(course))} plans")
    if image is not None:
        figure.colorbar(image, ax=axes, label="simulated time (s)", shrink=0.6)
    figure.suptitle(f"The hand's way by every plan of one trial, and the way it went (black); {courses[0][1].name}")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "seeding.png"
    figure.savefig(path, dpi=90)
    return path


def _draw(ax: Any, course: Course, across: int, up: int) -> Any:
    from matplotlib.collections import LineCollection

    kinematics = load_kinematics(course.description.robot)
    plans = _plans(course)
    ways = [kinematics.fk_many(_dense(waypoints))[:, :3, 3][:, [across, up]] for _, waypoints in plans]
    lines = LineCollection(ways, cmap="viridis", linewidths=1.0, alpha=0.8)
    lines.set_array(np.array([t_s for t_s, _ in plans]))
    ax.add_collection(lines)
    went = kinematics.fk_many(course.qs)[:, :3, 3]
    ax.plot(went[:, across], went[:, up], color="black", linewidth=2.0)
    belt = course.description.belt_path_world
    ax.plot(belt[:, across], belt[:, up], color="0.6", linewidth=6.0, alpha=0.5)
    for T in course.Ts_world_obstacle:
        ax.plot(T[across, 3], T[up, 3], marker="s", markersize=10, color="tab:red", alpha=0.5)
    slab = course.description.slab
    if slab is not None:
        corners = np.array(np.meshgrid(*((-s / 2, s / 2) for s in slab.size_m))).reshape(3, -1)
        placed = slab.T_world_box.rotation @ corners + slab.T_world_box.xyz_m[:, None]
        from scipy.spatial import ConvexHull

        flat = placed[[across, up]].T
        ax.fill(*flat[ConvexHull(flat).vertices].T, color="tab:red", alpha=0.25)
    ax.autoscale_view()
    return lines


def _plans(course: Course) -> list[tuple[float, Array]]:
    return [(cycle.observed_s, cycle.plan.path.waypoints) for cycle in course.cycles if cycle.plan is not None]


def _dense(waypoints: Array) -> Array:
    parts = [np.linspace(a, b, max(2, int(np.linalg.norm(b - a) / STEP_RAD))) for a, b in itertools.pairwise(waypoints)]
    return np.concatenate(parts) if parts else waypoints
