"""``bench motion`` and ``bench lifts``: figures beside what is wanted of them."""

import argparse
import json
import os
from collections.abc import Iterator
from pathlib import Path

from backend.bench.figure import Figure
from backend.cli.telling import Teller
from backend.machine import machine

LIFTS, FEW_LIFTS = 100, 2
"""Of each hand and object."""


def run(options: argparse.Namespace) -> int:
    """Print every figure; always 0, as a figure may be missed on a slow machine."""
    where, load = machine(), os.getloadavg()[0]
    if not options.json:
        print(f"{where}; load {load:.1f} at the start: times are wall time, and worth little while others compute")
    found: list[dict[str, object]] = []
    part = ""
    for figure in _figures(options):
        found.append(figure.as_dict())
        if options.json:
            continue
        if figure.part != part:
            part = figure.part
            print(part)
        print(figure.line(), flush=True)
    if options.json:
        print(json.dumps({"machine": where, "load": load, "quick": bool(options.quick), options.what: found}))
    return 0


def _figures(options: argparse.Namespace) -> Iterator[Figure]:
    if options.what == "lifts":
        from backend.bench import lifts

        return lifts.measure(FEW_LIFTS if options.quick else LIFTS, 0)
    from backend.bench import motion_bench
    from backend.bench.sizes import FULL, QUICK

    drawn = Path(options.figures) if options.figures else None
    return motion_bench.measure(QUICK if options.quick else FULL, 0, Teller("bench motion"), drawn)
