"""Pictures of grasp databases: the grasps around each object, coloured by how often they held."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from backend.knowledge.grasps import GraspDatabase
from backend.objects import load_object
from backend.pose import Array

STEM_M = 0.05
FINGER_M = 0.025
HALF_OPENING_M = 0.02
LOWEST_RATE = 0.7


def draw_grasps(databases: list[GraspDatabase], folder: Path) -> Path:
    """Write ``grasps_<robot>.png`` into ``folder``, a panel per database of one robot."""
    from matplotlib.figure import Figure

    columns = min(4, len(databases))
    rows = -(-len(databases) // columns)
    figure = Figure(figsize=(3.6 * columns, 3.8 * rows), layout="constrained")
    for k, database in enumerate(databases):
        _panel(figure.add_subplot(rows, columns, k + 1, projection="3d"), database)
    figure.suptitle(f"Kept grasps of {databases[0].robot}; green held always, violet {LOWEST_RATE:.0%} or less")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"grasps_{databases[0].robot}.png"
    figure.savefig(path, dpi=80)
    return path


def _panel(axes: Any, database: GraspDatabase) -> None:
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    target = load_object(database.object)
    color = tuple(c / 255 for c in target.color_rgb)
    faces = Poly3DCollection(target.visual.triangles, facecolor=color, edgecolor="none", alpha=0.35)
    axes.add_collection3d(faces)
    shades = np.clip((database.quality - LOWEST_RATE) / (1.0 - LOWEST_RATE), 0.0, 1.0)
    strokes = np.concatenate([hand_strokes(T) for T in database.Ts_object_grasp])
    colors = np.repeat(colormaps["viridis"](0.85 * shades), len(strokes) // len(database), axis=0)
    axes.add_collection3d(Line3DCollection(list(strokes), colors=colors, linewidths=0.7))
    points = np.concatenate([strokes.reshape(-1, 3), target.visual.bounds_m])
    middle, reach = 0.5 * (points.min(axis=0) + points.max(axis=0)), 0.5 * float(np.ptp(points, axis=0).max())
    axes.set(**{f"{axis}lim": (middle[i] - reach, middle[i] + reach) for i, axis in enumerate("xyz")})
    axes.set_title(f"{target.title}: {len(database)}, mean rate {database.quality.mean():.2f}", fontsize=9)
    axes.set_axis_off()
    axes.set_box_aspect((1, 1, 1), zoom=1.35)
    axes.view_init(elev=22, azim=-50)


def hand_strokes(T_object_grasp: Array) -> Array:
    """(4, 2, 3) a two-finger hand as strokes in the object frame: two fingers, the palm, the stem."""
    w, f, s = HALF_OPENING_M, FINGER_M, STEM_M
    corners = [(0, w, 0), (0, w, -f), (0, -w, 0), (0, -w, -f), (0, w, -f), (0, -w, -f), (0, 0, -f), (0, 0, -s)]
    points = np.array(corners, dtype=np.float64)
    return (points @ T_object_grasp[:3, :3].T + T_object_grasp[:3, 3]).reshape(4, 2, 3)
