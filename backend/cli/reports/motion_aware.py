"""``report motion-aware``: how good the models that come with the project are, as kept in their files or afresh."""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from backend.build.motion_data import source_of
from backend.build.motion_figure import draw_curves
from backend.build.motion_measure import measure
from backend.cli.choices import chosen_objects, chosen_robots, chosen_workers
from backend.errors import InvalidInputError
from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import MotionAwareModel, load_motion_aware
from backend.parallel import spread

HEAD = f"{'':<32} {'n':>6} {'held':>6} {'accuracy':>9} {'FPR':>6} {'FNR':>6} {'Brier':>6} {'ECE':>6}"


@dataclass(frozen=True)
class _Job:
    robot: str
    object: str
    seed: int
    attempts: int


def tables(options: argparse.Namespace) -> dict[str, Any]:
    """A table per hand and object."""
    if options.attempts < 0:
        raise InvalidInputError(f"--attempts must not be negative (got {options.attempts})")
    workers, robots, objects = chosen_workers(options), chosen_robots(options), chosen_objects(options)
    models = {(robot, name): load_motion_aware(robot, name) for robot in robots for name in objects}
    if options.figures:
        for robot in robots:
            path = draw_curves(robot, [models[robot, name] for name in objects], Path(options.figures))
            print(f"{robot}: curves in {path}", file=sys.stderr)
    fresh = _afresh([_Job(*pair, options.seed, options.attempts) for pair in models], workers)
    return {"motion_aware": [_table(model, fresh.get(pair, {})) for pair, model in models.items()]}


def show(measured: dict[str, Any]) -> None:
    """One table per hand."""
    found = measured["motion_aware"]
    for robot in dict.fromkeys(table["robot"] for table in found):
        _print(robot, [table for table in found if table["robot"] == robot])


def _afresh(jobs: list[_Job], workers: int) -> dict[tuple[str, str], dict[str, Any]]:
    """What fresh attempts say of each model; nothing when none are asked for."""
    if not jobs or jobs[0].attempts == 0:
        return {}
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for pair, measured in spread(_measured, jobs, min(workers, len(jobs))):
        found[pair] = measured
        print(f"{pair[0]} {pair[1]} measured", file=sys.stderr, flush=True)
    return found


def _measured(job: _Job) -> tuple[tuple[str, str], dict[str, Any]]:
    model = load_motion_aware(job.robot, job.object)
    source = source_of(load_grasps(job.robot, job.object), job.seed)
    return (job.robot, job.object), measure(source, model, job.attempts, model.facts["attempts"])


def _table(model: MotionAwareModel, fresh: dict[str, Any]) -> dict[str, Any]:
    facts = model.facts
    kept = {name: facts[name] for name in ("attempts", "seed", "measured", "curves", "ends")}
    source = source_of(load_grasps(model.robot, model.object), facts["seed"])
    up_to_date = source.digest() == facts["source"]
    return {"robot": model.robot, "object": model.object, "up_to_date": up_to_date, **kept, **fresh}


def _print(robot: str, tables: list[dict[str, Any]]) -> None:
    parts = {"trials": "other attempts, same grasps", "grasps": "grasps never trained on"}
    for part, title in parts.items():
        print(f"\n{robot}: {title}\n{HEAD}")
        for table in tables:
            print(_line(table["object"], table["measured"][part]))
            if f"{part}_as_in_database" in table["measured"]:
                print(_line("  grasps as in the database", table["measured"][f"{part}_as_in_database"]))
        print(_line("mean", _mean([table["measured"][part] for table in tables])))
    old = [table["object"] for table in tables if not table["up_to_date"]]
    if old:
        print(f"\nLearnt from other grasps, shapes, settings or code than are here now: {', '.join(old)}")
    fresh = [table for table in tables if "fresh" in table]
    if not fresh:
        return
    print(f"\n{robot}: fresh attempts\n{HEAD}")
    for table in fresh:
        for band, row in table["fresh"].items():
            print(_line(table["object"] if band == "all" else f"  {band}", row))
        chance, worth = table["chance"], table["worth"]
        print(
            f"  chance caps accuracy at about {chance['accuracy']:.3f} and Brier at {chance['brier']:.3f} "
            f"({chance['cases']} cases); top 5 hold {worth['ranked']:.3f}, any grasp {worth['anyhow']:.3f} "
            f"(difference +- {1.96 * worth['standard_error']:.3f}, {worth['motions']} motions)"
        )
    for band in fresh[0]["fresh"]:
        rows = [table["fresh"][band] for table in fresh if band in table["fresh"]]
        print(_line("mean" if band == "all" else f"  {band}", _mean(rows)))


def _mean(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Each rate's mean over objects that have it; n is all their attempts."""
    means: dict[str, Any] = {"n": sum(row["n"] for row in rows)}
    for name in rows[0].keys() - {"n"}:
        known = [row[name] for row in rows if row[name] is not None]
        means[name] = sum(known) / len(known) if known else None
    return means


def _line(title: str, row: dict[str, Any]) -> str:
    rates = " ".join(
        f"{'-':>6}" if row[name] is None else f"{row[name]:>6.3f}"
        for name in ("false_positive_rate", "false_negative_rate", "brier", "calibration_error")
    )
    return f"{title:<32} {row['n']:>6} {row['base_rate']:>6.3f} {row['accuracy']:>9.3f} {rates}"
