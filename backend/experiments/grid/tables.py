"""Tables: the rows of a grid as Parquet and CSV files, for whatever reads tables."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from backend.errors import StorageError
from backend.experiments.grid.row import GridRow
from backend.files import replacing

ARROW: dict[Any, pa.DataType] = {
    str: pa.string(),
    bool: pa.bool_(),
    int: pa.int64(),
    str | None: pa.string(),
    float | None: pa.float64(),
}
SCHEMA = pa.schema([pa.field(name, ARROW[hint]) for name, hint in get_type_hints(GridRow).items()])


def write_tables(rows: Iterable[GridRow], folder: Path) -> list[Path]:
    """``trials.parquet`` and ``trials.csv``, one line per trial, each file whole or not at all.

    Raises ``StorageError``.
    """
    ordered = sorted(rows, key=lambda row: row.key)
    table = pa.Table.from_pylist([row.as_dict() for row in ordered], schema=SCHEMA)
    files = [folder / "trials.parquet", folder / "trials.csv"]
    try:
        with replacing(files[0]) as file:
            pyarrow.parquet.write_table(table, file, compression="zstd")
        with replacing(files[1]) as file:
            pyarrow.csv.write_csv(table, file)
    except OSError as error:
        raise StorageError(f"Cannot write the tables to {folder}: {error.strerror or error}.") from error
    return files
