"""``build motion-aware``: gather attempts in simulation, then learn from them how likely a grasp holds in motion."""

import argparse
import json
import os
import sys
import time
from typing import Any

from backend.build.motion_data import OnProgress, gather, source_of
from backend.errors import InvalidInputError, lookup
from backend.knowledge.grasps import load_grasps
from backend.knowledge.motion_aware import save_motion_aware
from backend.objects import OBJECTS, object_names
from backend.robots import ROBOTS

LEAST = 100


def build_all(options: argparse.Namespace) -> int:
    """The models asked for, one after the other, each saved when it is done; killed and begun again, it goes on."""
    workers = options.workers if options.workers is not None else os.cpu_count() or 1
    if workers < 1:
        raise InvalidInputError(f"--workers must be at least 1 (got {workers})")
    if options.attempts < LEAST:
        raise InvalidInputError(f"--attempts must be at least {LEAST} (got {options.attempts})")
    for kind, name, table in (("robot", options.robot, ROBOTS), ("object", options.object, object_names())):
        if name is not None:
            lookup(kind, name, dict.fromkeys(table))
    from backend.build.motion_aware import build_motion_aware

    built: list[dict[str, Any]] = []
    for robot in [options.robot] if options.robot else list(ROBOTS):
        for name in [options.object] if options.object else list(OBJECTS):
            begun_s = time.perf_counter()
            source = source_of(load_grasps(robot, name), options.seed)
            tell = _teller(robot, name)
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


def _teller(robot: str, name: str) -> OnProgress:
    def tell(text: str) -> None:
        print(f"{robot} {name}: {text}", file=sys.stderr, flush=True)

    return tell
