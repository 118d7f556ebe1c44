"""``survey``: success of scenarios x objects x seeds, by scenario, by object and by robot."""

import argparse
import json
import os
import time
from pathlib import Path
from typing import Any

from backend.cli.telling import Teller
from backend.errors import InvalidInputError
from backend.experiments.survey import Job, Row, run_jobs, summary
from backend.objects import OBJECTS
from backend.scenario import load_scenario, scenario_names, with_overrides


def run(options: argparse.Namespace) -> int:
    """Run the trials and print the tables; always 0."""
    if options.seeds < 1:
        raise InvalidInputError(f"--seeds must be at least 1 (got {options.seeds})")
    if options.workers is not None and options.workers < 1:
        raise InvalidInputError(f"--workers must be at least 1 (got {options.workers})")
    jobs = _jobs(options)
    rows: list[Row] = []
    begun_s, tell = time.perf_counter(), Teller()
    for row in run_jobs(jobs, options.workers or os.cpu_count() or 1):
        rows.append(row)
        tell(_progress(rows, len(jobs), time.perf_counter() - begun_s))
    rows.sort(key=lambda row: (row.name, row.record.object, row.record.seed))
    if options.out is not None:
        lines = [json.dumps({"name": row.name, **row.record.as_dict()}) for row in rows]
        partial = Path(options.out + ".part")
        partial.write_text("\n".join(lines) + "\n")
        partial.replace(options.out)
    tables = {
        "by scenario": summary(rows, lambda row: row.name),
        "by object": summary(rows, lambda row: f"{row.record.robot} {row.record.object}"),
        "by robot": summary(rows, lambda row: row.record.robot),
    }
    if options.json:
        print(json.dumps(tables))
        return 0
    for title, lines in tables.items():
        print(_table(title, lines))
    return 0


def _jobs(options: argparse.Namespace) -> list[Job]:
    names: list[str] = options.scenarios or list(scenario_names())
    objects: list[str] = options.objects or list(OBJECTS)  # the paper's seven, whatever else a user has
    jobs: list[Job] = []
    for name in names:
        base = with_overrides(load_scenario(name), options.overrides)
        for object_name in objects:
            scenario = with_overrides(base, [f"object={object_name}"])
            jobs += [Job(name, scenario, seed) for seed in range(options.seeds)]
    return jobs


def _progress(rows: list[Row], total: int, elapsed_s: float) -> str:
    done, held = len(rows), sum(row.record.strict for row in rows)
    return f"{done} of {total} trials, {done / elapsed_s:.2f}/s, strict success {held / done:.3f}"


def _table(title: str, lines: list[dict[str, Any]]) -> str:
    out = [f"\n| {title} | n | strict | authors | lifted after | failures |", "|---|---|---|---|---|---|"]
    for line in lines:
        reasons = ", ".join(f"{reason} {count}" for reason, count in line["reasons"].items())
        lifted = "" if line["lift_end_s"] is None else f"{line['lift_end_s']:.1f} s"
        rates = f"{line['strict']:.3f} | {line['authors']:.3f}"
        out.append(f"| {line['name']} | {line['n']} | {rates} | {lifted} | {reasons} |")
    return "\n".join(out)
