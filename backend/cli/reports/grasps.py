"""``report grasps``: how good and how many-sided the grasp databases are, and how quickly lifts are simulated."""

import argparse
import sys
from collections import Counter
from pathlib import Path
from typing import Any

from backend.build.grasp_figure import draw_grasps
from backend.build.grasps import BRISK
from backend.build.racing import Heat, lifts_per_second
from backend.build.sectors import SECTORS, count_by_sector
from backend.cli.choices import chosen_objects, chosen_robots
from backend.errors import InvalidInputError
from backend.knowledge.grasps import GraspDatabase, load_grasps


def tables(options: argparse.Namespace) -> dict[str, Any]:
    """A row per hand and object."""
    if options.lifts < 0:
        raise InvalidInputError(f"--lifts must not be negative (got {options.lifts})")
    objects = chosen_objects(options)
    rows: list[dict[str, Any]] = []
    for robot in chosen_robots(options):
        databases = [load_grasps(robot, name) for name in objects]
        rows += [_row(database, options.lifts, options.seed) for database in databases]
        if options.figures:
            print(f"{robot}: {draw_grasps(databases, Path(options.figures))}", file=sys.stderr)
    return {"grasps": rows}


def _row(database: GraspDatabase, lifts: int, seed: int) -> dict[str, Any]:
    row: dict[str, Any] = {
        "robot": database.robot,
        "object": database.object,
        "grasps": len(database),
        "mean_rate": round(float(database.quality.mean()), 4),
        "least_rate": round(float(database.quality.min()), 4),
        "lifts_each": int(database.lifts.min()),
        "candidates": database.facts.get("candidates"),
        "lifts": database.facts.get("lifts", int(database.lifts.sum())),
        "sectors_kept": count_by_sector(database.Ts_object_grasp),
        "sectors_that_lifted": database.facts.get("sectors_that_lifted"),
        "took_s": database.facts.get("took_s"),
    }
    if lifts:
        heat = Heat(database.robot, database.object, seed, BRISK)
        row["lifts_per_core_s"] = round(lifts_per_second(heat, database.Ts_object_grasp, lifts), 1)
    return row


def show(measured: dict[str, Any]) -> None:
    """One table; with lifts a second only where they were measured."""
    heads = ["hand, object", "kept", "mean rate", "least", "candidates", "/".join(SECTORS), "of those that lifted"]
    timed = any("lifts_per_core_s" in row for row in measured["grasps"])
    heads += ["lifts/s"] * timed
    print(f"| {' | '.join(heads)} |")
    print("|---" * len(heads) + "|")
    for row in measured["grasps"]:
        cells = [
            f"{row['robot']} {row['object']}",
            row["grasps"],
            f"{row['mean_rate']:.3f}",
            f"{row['least_rate']:.2f}",
            row["candidates"] or "",
            _counts(row["sectors_kept"]),
            _counts(row["sectors_that_lifted"]),
        ]
        if timed:
            cells.append(row["lifts_per_core_s"])
        print(f"| {' | '.join(map(str, cells))} |")


def _counts(by_sector: dict[str, int] | None) -> str:
    counted = Counter(by_sector)
    return " / ".join(str(counted[name]) for name in SECTORS) if by_sector else ""
