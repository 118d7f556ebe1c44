"""Success against speed and direction, drawn: the model's lines over what simulation did."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from backend.knowledge.motion_aware import MotionAwareModel

ROWS = (
    ("speed_mps", "speed (cm/s)", 100.0),
    ("direction_rad", "direction in the\nobject's frame (deg)", 180.0 / np.pi),
    ("from_behind_rad", "side grasps:\napproach to motion (deg)", 180.0 / np.pi),
)
SPREAD_95 = 1.96


def draw_curves(robot: str, models: list[MotionAwareModel], folder: Path) -> Path:
    """Write ``motion_aware_<robot>.png`` into ``folder``: one column per model, from the curves in its facts."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.6 * len(models) + 1.0, 8.0), layout="constrained")
    axes = np.atleast_2d(figure.subplots(len(ROWS), len(models), sharey=True, squeeze=False))
    for column, model in zip(axes.T, models, strict=True):
        column[0].set_title(model.object)
        for ax, (name, label, unit) in zip(column, ROWS, strict=True):
            _draw(ax, model.facts["curves"][name], unit)
            ax.set(xlabel=label, ylim=(0.0, 1.02))
    for row in axes:
        row[0].set_ylabel("share held")
    axes[0, 0].legend(fontsize="small", loc="lower left")
    figure.suptitle(f"Attempts never trained on, {robot}")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"motion_aware_{robot}.png"
    figure.savefig(path, dpi=90)
    return path


def _draw(ax: Any, curve: dict[str, list[float]], unit: float) -> None:
    """Shares with 95 % intervals (Wilson 1927), and the model's mean over the same attempts."""
    edges, n = unit * np.array(curve["edges"]), np.array(curve["n"], dtype=np.float64)
    some = n > 0
    middles, n = (0.5 * (edges[1:] + edges[:-1]))[some], n[some]
    share = np.array(curve["held"])[some] / n
    z2 = SPREAD_95**2
    middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n)
    half = SPREAD_95 * np.sqrt(share * (1.0 - share) / n + z2 / (4.0 * n**2)) / (1.0 + z2 / n)
    away = np.maximum([share - (middle - half), (middle + half) - share], 0.0)
    ax.errorbar(middles, share, yerr=away, fmt="o", color="black", markersize=3, linewidth=1.0, label="simulation")
    ax.plot(middles, np.array(curve["model"])[some], color="tab:blue", label="model")
    ax.grid(alpha=0.3)
