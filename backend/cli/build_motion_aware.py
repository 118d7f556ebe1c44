"""``build motion-aware``: gather attempts in simulation, then learn from them how likely a grasp holds in motion."""

import argparse
import json
import time
from typing import Any

from backend.build.motion_data import gather, source_of
from backend.cli.choices import UP_TO_DATE, chosen_pairs, chosen_workers, shelved
from backend.cli.telling import Teller
from backend.errors import InvalidInputError
from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import load_motion_aware, save_motion_aware

LEAST = 100


def build_all(options: argparse.Namespace) -> int:
    """The models asked for, one after the other, each saved when it is done; killed and begun again, it goes on."""
    workers = chosen_workers(options)
    pairs = chosen_pairs(options)
    if options.attempts < LEAST:
        raise InvalidInputError(f"--attempts must be at least {LEAST} (got {options.attempts})")
    from backend.build.motion_aware import build_motion_aware, is_up_to_date

    built: list[dict[str, Any]] = []
    for robot, name in pairs:
        begun_s = time.perf_counter()
        source = source_of(load_grasps(robot, name), options.seed)
        tell = Teller(robot, name)
        there = None if options.again else shelved(load_motion_aware, robot, name)
        if there is not None and is_up_to_date(there, source, options.attempts):
            tell(UP_TO_DATE)
            continue
        attempts = gather(source, options.attempts, workers, tell)
        model = build_motion_aware(source, attempts, tell)
        path = save_motion_aware(model)
        took_s = round(time.perf_counter() - begun_s, 1)
        trials = model.facts["measured"]["trials"]
        built.append({"robot": robot, "object": name, "file": str(path), "took_s": took_s, "trials": trials})
        if not options.json:
            shares = f"accuracy {trials['accuracy']:.3f}, base rate {trials['base_rate']:.3f}"
            print(f"{robot} {name}: {len(attempts)} attempts, {shares}")
    if options.json:
        print(json.dumps({"models": built}))
    return 0
