"""``bench motion``: planners, kinematics and retiming measured beside what is wanted of them."""

import argparse
import json
import os
from pathlib import Path

from backend.bench.motion_bench import measure
from backend.bench.sizes import FULL, QUICK
from backend.cli.choices import teller
from backend.machine import machine


def run(options: argparse.Namespace) -> int:
    """Print every figure; always 0, as a figure may be missed on a slow machine."""
    where, load = machine(), os.getloadavg()[0]
    if not options.json:
        print(f"{where}; load {load:.1f} at the start: times are wall time, and worth little while others compute")
    found: list[dict[str, object]] = []
    part = ""
    size = QUICK if options.quick else FULL
    for figure in measure(size, 0, teller("bench motion"), Path(options.figures) if options.figures else None):
        found.append(figure.as_dict())
        if options.json:
            continue
        if figure.part != part:
            part = figure.part
            print(part)
        print(figure.line(), flush=True)
    if options.json:
        print(json.dumps({"machine": where, "load": load, "quick": bool(options.quick), "motion": found}))
    return 0
