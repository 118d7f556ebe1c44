"""``report prediction``: how far each predictor is off, over motions, noise and time ahead."""

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from backend.errors import InvalidInputError
from backend.experiments.prediction import AHEAD_S, NOISES_M, PREDICTORS, UNSURE, measure
from backend.pose import Array

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
    ahead = ", ".join(f"{s:g}" for s in AHEAD_S)
    for noise_m in NOISES_M:
        under = f"{ahead} s ahead under {1e3 * noise_m:g} mm noise"
        noisy = [row for row in rows if row["noise_mm"] == 1e3 * noise_m]
        print(f"\nError in mm {under}: mean (95th percentile)\n\n{_table(PREDICTORS, noisy, _error)}")
        print(f"\nWithin two of the claimed standard deviations {under}, %\n\n{_table(UNSURE, noisy, _within)}")
    times = {
        name: np.median([row["median_predict_ms"] for row in rows if row["predictor"] == name]) for name in PREDICTORS
    }
    print("\nOne prediction: " + ", ".join(f"{name} {took_ms:.3f} ms" for name, took_ms in times.items()))


def _table(predictors: Sequence[str], rows: list[Row], cell: Callable[[list[Row]], str]) -> str:
    out = [f"| motion | {' | '.join(predictors)} |", "|---" * (1 + len(predictors)) + "|"]
    named = [(family, [row for row in rows if row["family"] == family]) for family in _families(rows)]
    for title, of_the_tasks in (("mean of tasks", True), ("mean of unseen", False)):
        named.append((title, [row for row in rows if row["of_the_tasks"] == of_the_tasks]))
    for title, chosen in named:
        if chosen:
            cells = [cell([row for row in chosen if row["predictor"] == name]) for name in predictors]
            out.append(f"| {title} | {' | '.join(cells)} |")
    return "\n".join(out)


def _families(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(row["family"] for row in rows))


def _error(rows: list[Row]) -> str:
    mean, high = (_mean(rows, name) for name in ("mean_mm", "p95_mm"))
    return f"{_shown(mean, 1)} ({_shown(high, 1)})"


def _within(rows: list[Row]) -> str:
    return _shown(100.0 * _mean(rows, "within_two_sigma"), 0)


def _mean(rows: list[Row], name: str) -> Array:
    return np.mean([row[name] for row in rows], axis=0)


def _shown(values: Array, digits: int) -> str:
    return " / ".join(f"{value:.{digits}f}" for value in values.tolist())
