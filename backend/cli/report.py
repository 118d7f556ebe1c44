"""``report``: measure what the robot knows beforehand, from the files that come with the project."""

import argparse
import importlib
import json
from typing import Any

from backend.cli.reports import REPORTS
from backend.errors import InvalidInputError


def run(options: argparse.Namespace) -> int:
    """Print the tables; always 0."""
    if options.seed < 0:
        raise InvalidInputError(f"--seed must not be negative (got {options.seed})")
    measured: dict[str, Any] = {}
    for what in REPORTS if options.what == "knowledge" else (options.what,):
        report = importlib.import_module(f"backend.cli.reports.{what.replace('-', '_')}")
        tables = report.tables(options)
        measured |= tables
        if not options.json:
            report.show(tables)
    if options.json:
        print(json.dumps(measured))
    return 0
