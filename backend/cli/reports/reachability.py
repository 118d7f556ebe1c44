"""``report reachability``: how far the fields that come with the project agree with IK."""

import argparse
import sys
from pathlib import Path
from typing import Any

from backend.build.reach_figure import draw_slices
from backend.build.reach_finish import report
from backend.cli.choices import chosen_robots
from backend.cli.telling import Teller
from backend.errors import InvalidInputError
from backend.kinematics import load_kinematics
from backend.knowledge.reachability import load_reachability


def tables(options: argparse.Namespace) -> dict[str, Any]:
    """A table per arm."""
    if options.poses < 100:
        raise InvalidInputError(f"--poses must be at least 100 (got {options.poses})")
    found: list[dict[str, Any]] = []
    for robot in chosen_robots(options):
        reach = load_reachability(robot)
        if options.figures:
            path = draw_slices(reach, Path(options.figures))
            print(f"{robot}: slices in {path}", file=sys.stderr)
        found.append(report(reach, load_kinematics(robot), options.seed, options.poses, Teller()))
    return {"reachability": found}


def show(measured: dict[str, Any]) -> None:
    """One after the other."""
    for table in measured["reachability"]:
        _print(table)


def _print(table: dict[str, Any]) -> None:
    print(f"{table['robot']}: {' x '.join(map(str, table['levels']))} levels")
    print(f"  {'poses':<28} {'by':<26} {'n':>7} {'accuracy':>9} {'FP/all':>8} {'FP/unreach.':>11} {'FN/all':>8}")
    for row in table["agreement"]:
        print(
            f"  {row['poses']:<28} {row['by']:<26} {row['poses_asked']:>7} {row['accuracy']:>9.4f} "
            f"{row['false_positives']:>8.4f} {row['false_positive_rate']:>11.4f} {row['false_negatives']:>8.4f}"
        )
    print(f"  rank correlation with manipulability {table['manipulability_rank_correlation']:.2f}, ", end="")
    print(f"with lasting reachability {table['lasting_rank_correlation']:.2f}")
    print(f"  100 poses in {table['query_ms_per_100']:.3f} ms; zero shifted by {table['shift_mm']:.1f} mm")
