"""``report``: measure what the robot knows beforehand, from the files that come with the project."""

import argparse
import json
import sys

import numpy as np

from backend.errors import InvalidInputError
from backend.experiments.prediction import AHEAD_S, NOISES_M, PREDICTORS, Errors, measure
from backend.pose import Array


def run(options: argparse.Namespace) -> int:
    """Print the tables; always 0."""
    if options.seed < 0:
        raise InvalidInputError(f"--seed must not be negative (got {options.seed})")
    if options.what == "reachability":
        from backend.cli.report_reachability import report_reachability

        return report_reachability(options)
    if options.what == "motion-aware":
        from backend.cli.report_motion_aware import report_motion_aware

        return report_motion_aware(options)
    return _prediction(options)


def _prediction(options: argparse.Namespace) -> int:
    """How far each predictor is off, over motions, noise and time ahead."""
    if options.motions < 1:
        raise InvalidInputError(f"--motions must be at least 1 (got {options.motions})")
    rows: list[Errors] = []
    for row in measure(options.motions, options.seed, options.families):
        rows.append(row)
        if row.predictor == PREDICTORS[-1] and row.noise_m == NOISES_M[-1]:
            print(f"{row.family} measured", file=sys.stderr, flush=True)
    if options.json:
        print(json.dumps({"ahead_s": AHEAD_S, "errors": [row.as_dict() for row in rows]}))
        return 0
    for noise_m in NOISES_M:
        print(_table(noise_m, [row for row in rows if row.noise_m == noise_m]))
    times = {name: np.median([row.median_predict_s for row in rows if row.predictor == name]) for name in PREDICTORS}
    print("\nOne prediction: " + ", ".join(f"{name} {1e3 * took_s:.3f} ms" for name, took_s in times.items()))
    return 0


def _table(noise_m: float, rows: list[Errors]) -> str:
    """Families down, predictors across; the means over families are of the tasks' and of the others'."""
    ahead = ", ".join(f"{s:g}" for s in AHEAD_S)
    out = [
        f"\nError in mm {ahead} s ahead under {1e3 * noise_m:g} mm noise: mean (95th percentile)\n",
        f"| motion | {' | '.join(PREDICTORS)} |",
        "|---" * (1 + len(PREDICTORS)) + "|",
    ]
    for family in dict.fromkeys(row.family for row in rows):
        out.append(_line(family, [[row] for row in rows if row.family == family]))
    for title, of_the_tasks in (("mean of tasks", True), ("mean of unseen", False)):
        chosen = [row for row in rows if row.of_the_tasks == of_the_tasks]
        if chosen:
            out.append(_line(title, [[row for row in chosen if row.predictor == name] for name in PREDICTORS]))
    return "\n".join(out)


def _line(title: str, cells: list[list[Errors]]) -> str:
    return f"| {title} | " + " | ".join(_cell(rows) for rows in cells) + " |"


def _cell(rows: list[Errors]) -> str:
    mean = np.mean([row.off_m.mean(axis=0) for row in rows], axis=0)
    high = np.mean([np.percentile(row.off_m, 95, axis=0) for row in rows], axis=0)
    return f"{_mm(mean)} ({_mm(high)})"


def _mm(values_m: Array) -> str:
    return " / ".join(f"{1e3 * value:.1f}" for value in values_m)
