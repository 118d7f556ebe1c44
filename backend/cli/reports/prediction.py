"""``report prediction``: how far each predictor is off, over motions, noise and time ahead."""

import argparse
import sys
from typing import Any

import numpy as np

from backend.errors import InvalidInputError
from backend.experiments.prediction import AHEAD_S, NOISES_M, PREDICTORS, measure

Row = dict[str, Any]


def tables(options: argparse.Namespace) -> dict[str, Any]:
    """Every predictor on every motion under every noise."""
    if options.motions < 1:
        raise InvalidInputError(f"--motions must be at least 1 (got {options.motions})")
    rows: list[Row] = []
    for row in measure(options.motions, options.seed, options.families):
        rows.append(row.as_dict())
        if row.predictor == PREDICTORS[-1] and row.noise_m == NOISES_M[-1]:
            print(f"{row.family} measured", file=sys.stderr, flush=True)
    return {"ahead_s": AHEAD_S, "errors": rows}


def show(measured: dict[str, Any]) -> None:
    """Families down, predictors across; the means over families are of the tasks' and of the others'."""
    rows: list[Row] = measured["errors"]
    for noise_m in NOISES_M:
        print(_table(noise_m, [row for row in rows if row["noise_mm"] == 1e3 * noise_m]))
    times = {
        name: np.median([row["median_predict_ms"] for row in rows if row["predictor"] == name]) for name in PREDICTORS
    }
    print("\nOne prediction: " + ", ".join(f"{name} {took_ms:.3f} ms" for name, took_ms in times.items()))


def _table(noise_m: float, rows: list[Row]) -> str:
    ahead = ", ".join(f"{s:g}" for s in AHEAD_S)
    out = [
        f"\nError in mm {ahead} s ahead under {1e3 * noise_m:g} mm noise: mean (95th percentile)\n",
        f"| motion | {' | '.join(PREDICTORS)} |",
        "|---" * (1 + len(PREDICTORS)) + "|",
    ]
    for family in dict.fromkeys(row["family"] for row in rows):
        out.append(_line(family, [[row] for row in rows if row["family"] == family]))
    for title, of_the_tasks in (("mean of tasks", True), ("mean of unseen", False)):
        chosen = [row for row in rows if row["of_the_tasks"] == of_the_tasks]
        if chosen:
            out.append(_line(title, [[row for row in chosen if row["predictor"] == name] for name in PREDICTORS]))
    return "\n".join(out)


def _line(title: str, cells: list[list[Row]]) -> str:
    return f"| {title} | " + " | ".join(_cell(rows) for rows in cells) + " |"


def _cell(rows: list[Row]) -> str:
    mean, high = (np.mean([row[name] for row in rows], axis=0) for name in ("mean_mm", "p95_mm"))
    return f"{_mm(mean.tolist())} ({_mm(high.tolist())})"


def _mm(values: list[float]) -> str:
    return " / ".join(f"{value:.1f}" for value in values)
