"""``trial``: one trial, with a live line of phase and time."""

import argparse
import json
import sys
from pathlib import Path

from backend.errors import InvalidInputError
from backend.experiments.trial import run_trial
from backend.record import TrialRecord
from backend.scenario import load_scenario, with_overrides
from backend.snapshot import Snapshot


def run(options: argparse.Namespace) -> int:
    """0 when the object was grasped by the strict rule, else 1."""
    if options.seed is not None and options.seed < 0:
        raise InvalidInputError(f"--seed must not be negative (got {options.seed})")
    scenario = with_overrides(load_scenario(options.scenario), options.overrides)
    live = sys.stderr.isatty() and not options.json
    trace = None if options.trace is None else Path(options.trace)
    record = run_trial(scenario, options.seed, trace, _print_line if live else None)
    if live:
        print(file=sys.stderr)
    print(json.dumps(record.as_dict()) if options.json else describe(record))
    return 0 if record.strict else 1


def describe(record: TrialRecord) -> str:
    """The outcome in a few lines for people."""
    verdict = "grasped" if record.strict else f"failed: {record.reason}"
    lines = [
        f"{record.scenario}, {record.object}, method {record.method}, seed {record.seed}: {verdict}",
        f"  {record.detail}",
    ]
    if record.approach_start_s is not None:
        lines.append(f"  approach began at {record.approach_start_s:.2f} s; the trial took {record.end_s:.2f} s")
    if record.cycle_mean_ms is not None:
        lines.append(
            f"  {record.cycles} cycles, {record.cycle_mean_ms:.1f} ms each on average, "
            f"95 % within {record.cycle_p95_ms:.1f} ms"
        )
    return "\n".join([*lines, f"  fingerprint {record.fingerprint}"])


def _print_line(snapshot: Snapshot) -> None:
    object_m = snapshot.T_world_object.xyz_m
    print(
        f"\r{snapshot.t_s:6.2f} s  {snapshot.phase:<8}  {snapshot.cycles:4d} cycles  object at "
        f"({object_m[0]:+.2f}, {object_m[1]:+.2f}, {object_m[2]:+.2f}) m",
        end="",
        file=sys.stderr,
        flush=True,
    )
