"""Writes tables as CSV and Parquet."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from beatrix_zenoh.recording.export import Block

PARQUET: Final = ".parquet"


def write_table(path: Path, blocks: Iterable[Block]) -> int:
    """Write a table in the format of the path's ending, and return the number of rows; raises OSError.

    CSV is UTF-8 with commas, decimal points and one line of names. A missing value is an empty field, and null in Parquet.
    """
    rows, writer = 0, None
    with path.open("wb") as file:
        for block in blocks:
            batch = record_batch(block)
            if writer is None and path.suffix.lower() == PARQUET:
                writer = pyarrow.parquet.ParquetWriter(file, batch.schema)
            elif writer is None:
                file.write((",".join(batch.schema.names) + "\n").encode())  # pyarrow would quote the names
                quotes = "needed" if "note" in block else "none"  # pyarrow needs quotes for every text
                options = pyarrow.csv.WriteOptions(include_header=False, quoting_style=quotes)
                writer = pyarrow.csv.CSVWriter(file, batch.schema, write_options=options)
            writer.write_batch(batch)
            rows += batch.num_rows
        if writer is not None:
            writer.close()
    return rows


def record_batch(block: Block) -> pa.RecordBatch:
    """Return a block as columns of Arrow, with null for NaN and for unknown whole numbers."""
    columns = {}
    for name, values in block.items():
        if isinstance(values, list):
            columns[name] = pa.array(values, pa.string())
        else:
            missing = values < 0 if name in ("seq", "repeats") else np.isnan(values)
            # Adding 0 turns -0.0, which would be "-0" in a cell, into 0.
            columns[name] = pa.array(values + values.dtype.type(0), mask=missing)
    return pa.RecordBatch.from_pydict(columns)
