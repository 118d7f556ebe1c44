"""``replay``: run a traced trial, or one of a grid, again and say whether it is the same bit for bit."""

import argparse
import json
from pathlib import Path

from backend.errors import InvalidInputError
from backend.experiments.grid.cells import Key
from backend.experiments.grid.code import code_version
from backend.experiments.grid.folder import plan_of, read_grid
from backend.experiments.grid.work import run_job
from backend.experiments.trial import run_trial
from backend.record import load_trace


def run(options: argparse.Namespace) -> int:
    """0 when the fingerprints agree, else 1."""
    path = Path(options.what)
    if path.is_dir():
        return _of_grid(path, options.key, options.json)
    if options.key is not None:
        raise InvalidInputError(f"{path} is not the folder of a grid; a trace is one trial and needs no key.")
    trace = load_trace(path)
    record = run_trial(trace.scenario)
    made_with = f"version {trace.record['version']}, now {record.version}"
    return _compared(str(trace.record["fingerprint"]), record.fingerprint, made_with, options.json)


def _of_grid(folder: Path, text: str | None, as_json: bool) -> int:
    if text is None:
        raise InvalidInputError(f"Which trial of {folder}? Name its key, such as ur5_robotiq/linear/cube/ours_rm/17.")
    key = Key.parse(text)
    with read_grid(folder) as store:
        row, facts = store.row(key), store.facts
    if not row.fingerprint:
        raise InvalidInputError(f"{key} did not come to an end ({row.detail}), so there is nothing to compare with.")
    again = run_job(plan_of(facts).job(key), facts.settings)
    if not as_json:
        print(f"{key}: {'grasped' if again.strict else again.reason}. {again.detail}")
    return _compared(row.fingerprint, again.fingerprint, f"code {row.code}, now {code_version()}", as_json)


def _compared(recorded: str, replayed: str, made_with: str, as_json: bool) -> int:
    same = recorded == replayed
    if as_json:
        print(json.dumps({"same": same, "recorded": recorded, "replayed": replayed}))
    elif same:
        print(f"The same trial, bit for bit: fingerprint {replayed}.")
    else:
        print(f"A different trial: {recorded} was recorded, {replayed} came out ({made_with}).")
    return 0 if same else 1
