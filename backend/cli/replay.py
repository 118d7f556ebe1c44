"""``replay``: run a traced trial again and say whether it is the same bit for bit."""

import argparse
import json
from pathlib import Path

from backend.experiments.trial import run_trial
from backend.record import load_trace


def run(options: argparse.Namespace) -> int:
    """0 when the fingerprints agree, else 1."""
    trace = load_trace(Path(options.trace))
    record = run_trial(trace.scenario)
    recorded = trace.record["fingerprint"]
    same = record.fingerprint == recorded
    if options.json:
        print(json.dumps({"same": same, "recorded": recorded, "replayed": record.fingerprint}))
    elif same:
        print(f"The same trial, bit for bit: fingerprint {record.fingerprint}.")
    else:
        made_by = f"{trace.record['version']}, now {record.version}"
        print(f"A different trial: {recorded} was recorded, {record.fingerprint} came out (version {made_by}).")
    return 0 if same else 1
