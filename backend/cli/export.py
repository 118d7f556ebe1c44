"""``export``: the rows of a grid as Parquet and CSV."""

import argparse
import json
from pathlib import Path

from backend.experiments.grid.folder import read_grid
from backend.experiments.grid.tables import write_tables


def run(options: argparse.Namespace) -> int:
    """Write both files and name them; always 0."""
    folder = Path(options.folder)
    with read_grid(folder) as store:
        rows = list(store.rows())
    files = write_tables(rows, folder if options.to is None else Path(options.to))
    if options.json:
        print(json.dumps({"rows": len(rows), "files": [str(file) for file in files]}))
    else:
        print(f"{len(rows)} rows in {' and '.join(map(str, files))}")
    return 0
