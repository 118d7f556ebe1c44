"""``build``: make what the robot knows beforehand, and say how good it is."""

import argparse
import json
import time
from typing import Any

from backend.build import grasps
from backend.cli.choices import UP_TO_DATE, chosen_pairs, chosen_robots, chosen_workers, shelved
from backend.cli.telling import Teller
from backend.errors import InvalidInputError
from backend.files import cache_folder
from backend.kinematics import load_kinematics
from backend.knowledge.grasps import GraspDatabase, load_grasps, save_grasps
from backend.knowledge.predictor import load_weights, save_weights
from backend.knowledge.reachability import load_reachability, save_reachability
from backend.objects import OBJECTS
from backend.pipeline.predict.window import FEATURES, HORIZONS_S


def run(options: argparse.Namespace) -> int:
    """Build what is asked for; always 0."""
    if options.seed < 0:
        raise InvalidInputError(f"--seed must not be negative (got {options.seed})")
    match options.what:
        case "predictor":
            return _predictor(options)
        case "reachability":
            return _reachability(options)
        case "motion-aware":
            from backend.cli.build_motion_aware import build_all

            return build_all(options)
        case _:
            return _grasps(options)


def _grasps(options: argparse.Namespace) -> int:
    """The databases asked for, one after the other, each saved when it is done."""
    workers = chosen_workers(options)
    if options.count < 1:
        raise InvalidInputError(f"--count must be at least 1 (got {options.count})")
    built: list[dict[str, Any]] = []
    for robot, name in chosen_pairs(options):
        begun_s = time.perf_counter()
        tell = Teller(robot, name)
        there = None if options.again else shelved(load_grasps, robot, name)
        if there is not None and grasps.is_up_to_date(there, options.seed, options.count):
            tell(UP_TO_DATE)
            continue
        database = grasps.build_grasps(robot, name, options.seed, options.count, tell, workers=workers)
        path = save_grasps(database)
        entry = _entry(database, time.perf_counter() - begun_s) | {"file": str(path)}
        built.append(entry)
        if not options.json:
            print(f"{robot} {name}: {entry['grasps']} grasps, {entry['held']:.2f} of their lifts held")
    if options.json:
        print(json.dumps({"databases": built}))
    return 0


def _reachability(options: argparse.Namespace) -> int:
    """The field of each arm asked for, saved when it is calibrated, and checked on grasps of the databases."""
    workers = chosen_workers(options)
    if options.object is not None:
        raise InvalidInputError("--object is of grasps; a reachability field is of an arm, whatever it grasps")
    robots = chosen_robots(options)
    from backend.build.reach_finish import finished, is_up_to_date

    for robot in robots:
        for name in OBJECTS:
            load_grasps(robot, name)
    built: list[dict[str, Any]] = []
    for robot in robots:
        tell = Teller(robot, "reachability")
        there = None if options.again else shelved(load_reachability, robot)
        if there is not None and is_up_to_date(there, options.seed):
            tell(UP_TO_DATE)
            continue
        reach = finished(load_kinematics(robot), options.seed, tell, workers)
        path = save_reachability(reach)
        size_mb = path.stat().st_size / 1e6
        built.append({"robot": robot, "file": str(path), "size_mb": size_mb, "took_s": reach.facts["took_s"]})
        if not options.json:
            print(f"{robot}: built and calibrated in {reach.facts['took_s']} s, {size_mb:.2f} MB")
    if options.json:
        print(json.dumps({"fields": built}))
    return 0


def _predictor(options: argparse.Namespace) -> int:
    """Train the network of motion prediction; killed and begun again, it goes on where it was."""
    if options.robot is not None or options.object is not None:
        raise InvalidInputError("--robot and --object are of grasps; one predictor serves all robots and objects")
    from backend.build.predictor import build_predictor, is_up_to_date

    begun_s = time.perf_counter()
    tell = Teller("predictor", f"seed {options.seed}")
    there = None if options.again else shelved(load_weights, FEATURES, len(HORIZONS_S))
    if there is not None and is_up_to_date(there, options.seed):
        tell(UP_TO_DATE)
        if options.json:
            print(json.dumps({"predictor": None}))
        return 0
    checkpoint = cache_folder() / f"predictor-{options.seed}.pt"
    weights = build_predictor(options.seed, checkpoint, tell)
    path = save_weights(weights)
    checkpoint.unlink(missing_ok=True)
    measured = weights.facts["validation"]
    if options.json:
        took_s = round(time.perf_counter() - begun_s, 1)
        print(json.dumps({"predictor": {"file": str(path), "took_s": took_s, "validation": measured}}))
    else:
        print(f"{path}: off by {measured['lstm_mm']} mm at 0.5, 1 and 2 s; straight on, by {measured['line_mm']} mm")
    return 0


def _entry(database: GraspDatabase, took_s: float) -> dict[str, Any]:
    return {
        "robot": database.robot,
        "object": database.object,
        "grasps": len(database),
        "held": round(float(database.successes.sum() / database.lifts.sum()), 3),
        "took_s": round(took_s, 1),
    }
