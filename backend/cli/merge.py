"""``merge``: put the rows of a grid's shards, or of parts run elsewhere, into one folder."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from backend.experiments.grid.merging import merge


def run(options: argparse.Namespace) -> int:
    """Merge and say how many rows came; always 0."""
    folder = Path(options.folder)
    merged = merge(folder, [Path(other) for other in options.others], salvage=options.salvage)
    if options.json:
        print(json.dumps(asdict(merged)))
    else:
        print(f"{merged.files} files: {merged.added} rows added, {merged.there_already} were there already.")
    return 0
