"""``report``: of a grid's rows, or measure what the robot knows beforehand."""

import argparse
import importlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from backend.cli.reports import REPORTS
from backend.errors import InvalidInputError
from backend.experiments.grid.folder import plan_of, read_grid


def run(options: argparse.Namespace) -> int:
    """Print the tables; always 0."""
    if options.what not in (*REPORTS, "knowledge"):
        return _of_grid(options)
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


def _of_grid(options: argparse.Namespace) -> int:
    """Write the report of the grid in a folder."""
    folder = Path(options.what)
    if not folder.is_dir():
        there = ", ".join((*REPORTS, "knowledge"))
        raise InvalidInputError(
            f"There is no report of {options.what!r}: name the folder of a grid, or one of {there}."
        )
    with read_grid(folder) as store:
        rows, plan = list(store.rows()), plan_of(store.facts)
    from backend.experiments.report.document import report_of

    report = report_of(rows, plan, options.judge or plan.settings.judge)
    files = report.write(folder / "report" if options.to is None else Path(options.to))
    if options.json:
        print(json.dumps({"files": [str(file) for file in files], "cells": [asdict(cell) for cell in report.cells]}))
    else:
        print(report.markdown())
        print(f"Written: {files[0].parent}/{{{','.join(file.name for file in files)}}}")
    return 0
