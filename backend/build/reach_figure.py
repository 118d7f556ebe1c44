"""Slices of a reachability field, drawn: top-down and side grasps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from backend.knowledge.reachability import ReachabilityField
from backend.pose import Array

SIDE = 121
RANGE_M = 0.2


def draw_slices(reach: ReachabilityField, folder: Path) -> Path:
    """Write ``reachability_<robot>.png`` into ``folder``: distance over the tcp's place, for four approaches."""
    from matplotlib.figure import Figure

    radius_m = float(reach.steps[0] * (reach.levels.shape[0] - 1))
    height_m = float(reach.steps[1] * (reach.levels.shape[1] - 1))
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    axes = figure.subplots(2, 3)
    image = None
    for row, (title, approach) in zip(axes, _APPROACHES, strict=True):
        flat = ((0.05, "x", "y"), (0.25, "x", "y"), (None, "x", "z"))
        for ax, (fixed_m, across, up) in zip(row, flat, strict=True):
            xs = np.linspace(-radius_m, radius_m, SIDE)
            others = xs if fixed_m is not None else np.linspace(0.0, height_m, SIDE)
            grid_x, grid_o = np.meshgrid(xs, others)
            Ts = np.tile(np.eye(4), (grid_x.size, 1, 1))
            Ts[:, :3, :3] = approach
            Ts[:, 0, 3] = grid_x.ravel()
            Ts[:, 1 if fixed_m is not None else 2, 3] = grid_o.ravel()
            if fixed_m is not None:
                Ts[:, 2, 3] = fixed_m
            values = reach.signed_distance(Ts).reshape(grid_x.shape)
            extent = (xs[0], xs[-1], float(others[0]), float(others[-1]))
            image = ax.imshow(
                100.0 * values, origin="lower", extent=extent, cmap="RdBu", vmin=-100 * RANGE_M, vmax=100 * RANGE_M
            )
            ax.contour(grid_x, grid_o, values, levels=[0.0], colors="black", linewidths=1.0)
            place = f"z = {fixed_m:g} m" if fixed_m is not None else "y = 0"
            ax.set(title=f"{title}, {place}", xlabel=f"{across} (m)", ylabel=f"{up} (m)")
    if image is not None:
        figure.colorbar(image, ax=axes, label="signed distance (cm), blue reachable", shrink=0.8)
    figure.suptitle(f"Reachability of tcp poses, {reach.robot}")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"reachability_{reach.robot}.png"
    figure.savefig(path, dpi=90)
    return path


_DOWN: Array = np.diag([1.0, -1.0, -1.0])
_SIDE: Array = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""The hand's approach along the world's x, its fingers closing along z turned level."""
_APPROACHES = (("from above", _DOWN), ("along x from the side", _SIDE))
