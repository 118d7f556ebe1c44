"""``trials``: how the trials of scenarios begin, as a table that anybody can run, here by ``grid --trials-file``."""

import argparse
import json
from pathlib import Path

from backend.errors import InvalidInputError, StorageError, lookup
from backend.experiments.grid.trial_set import Row, drawn_set, to_csv
from backend.files import replacing
from backend.objects import object_names
from backend.scenario import load_scenario


def run(options: argparse.Namespace) -> int:
    """Write the table; always 0."""
    for name, least in (("n", 1), ("first_seed", 0)):
        if getattr(options, name) < least:
            flag = "--" + name.replace("_", "-")
            raise InvalidInputError(f"{flag} must be at least {least} (got {getattr(options, name)})")
    for name in options.objects or ():
        lookup("object", name, dict.fromkeys(object_names()))
    rows: list[Row] = []
    for task in options.task:
        scenario = load_scenario(task)
        rows += drawn_set(scenario, options.objects or [scenario.object], options.n, options.first_seed)
    try:
        with replacing(Path(options.file)) as file:
            file.write(to_csv(rows).encode())
    except OSError as error:
        raise StorageError(f"Cannot write {options.file}: {error.strerror}.") from error
    if options.json:
        print(json.dumps({"trials": len(rows), "file": options.file}))
    else:
        print(f"{len(rows)} trials in {options.file}")
    return 0
