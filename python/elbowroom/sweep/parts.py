"""The parts of a sweep: Parquet files that are complete or absent."""

from __future__ import annotations

import hashlib
import json
import os
import uuid
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import Error
from elbowroom.sweep.extras import imported
from elbowroom.sweep.questions import Column

_KEY = b"elbowroom.sweep"


@dataclass(frozen=True)
class Part:
    """What the footer of a part says.

    Attributes
    ----------
    task
        The digest of the task.
    first, rows
        The number of the first row, and of all rows.
    counts
        By column of numbers: how many rows are not 0.
    least
        By column of floats: the least finite value; `None` without one.
    sha256
        A hash of the answers, in hex.
    """

    task: str
    first: int
    rows: int
    counts: dict[str, int]
    least: dict[str, float | None]
    sha256: str

    @staticmethod
    def of(task: str, first: int, rows: int, columns: dict[str, Column]) -> Part:
        """Return the footer of answers."""
        arrays = {name: values for name, values in columns.items() if isinstance(values, np.ndarray)}
        counts = {name: int(np.count_nonzero(values)) for name, values in arrays.items() if values.dtype.kind in "bui"}
        floats = {name: values[np.isfinite(values)] for name, values in arrays.items() if values.dtype.kind == "f"}
        least = {name: float(values.min()) if len(values) else None for name, values in floats.items()}
        content = hashlib.sha256(f"{first} {rows} ".encode())
        for name, values in columns.items():
            content.update(name.encode() + b" ")
            content.update(values.tobytes() if isinstance(values, np.ndarray) else json.dumps(values).encode())
        return Part(task, first, rows, counts, least, content.hexdigest())


def path(folder: Path, shard: int) -> Path:
    """Return the file of a shard."""
    return folder / f"part-{shard:06}.parquet"


def write(file: Path, task: str, first: int, rows: int, columns: dict[str, Column]) -> Part:
    """Write a part: first under another name, which becomes its name when everything is on the disk."""
    pa, pq = imported("pyarrow", "pyarrow"), imported("pyarrow.parquet", "pyarrow")
    part = Part.of(task, first, rows, columns)
    names = [name for name, values in columns.items() if isinstance(values, list)]
    table: dict[str, Any] = {"index": pa.array(np.arange(first, first + rows, dtype=np.int64))}
    for name, values in columns.items():
        table[name] = pa.array(values, pa.string()).dictionary_encode() if name in names else pa.array(values)
    content = pa.table(table).replace_schema_metadata({_KEY: json.dumps(asdict(part)).encode()})
    # Two workers may compute one shard, if a cluster takes one of them for dead: each has a name of its own.
    unfinished = file.with_name(f"{file.name}.{uuid.uuid4().hex}.tmp")
    encodings = {"index": "DELTA_BINARY_PACKED"}
    with unfinished.open("wb") as out:
        pq.write_table(content, out, compression="zstd", use_dictionary=names, column_encoding=encodings)
        out.flush()
        os.fsync(out.fileno())
    os.replace(unfinished, file)
    return part


def read(file: Path) -> Part:
    """Read the footer of a part. Its columns are not read again.

    Raises
    ------
    Error
        If the file is not a part.
    """
    pq = imported("pyarrow.parquet", "pyarrow")
    try:
        footer = pq.ParquetFile(file)
        part = Part(**json.loads((footer.schema_arrow.metadata or {})[_KEY]))
        complete = footer.metadata.num_rows == part.rows
    except Exception as error:
        raise Error(f"{file}: is not a part of a sweep: {error}\n  write: another folder, or remove the file") from error
    if not complete:
        raise Error(f"{file}: has {footer.metadata.num_rows} rows, its footer says {part.rows}\n  write: remove the file")
    return part
