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
import numpy.typing as npt

from elbowroom.errors import Error
from elbowroom.sweep.extras import imported

_KEY = b"elbowroom.sweep"


@dataclass(frozen=True)
class Answers:
    """The answers about the states of a shard."""

    collides: npt.NDArray[np.bool_]
    distance_m: npt.NDArray[np.float32] | None = None
    a: list[str | None] | None = None
    b: list[str | None] | None = None

    def sha256(self, first: int) -> str:
        """Return the SHA-256 of the answers and of the number of the first state, in hex."""
        content = hashlib.sha256(f"{first} {len(self.collides)} ".encode())
        content.update(self.collides.tobytes())
        if self.distance_m is not None:
            content.update(self.distance_m.astype("<f4").tobytes())
        for names in (self.a, self.b):
            content.update(json.dumps(names).encode())
        return content.hexdigest()


@dataclass(frozen=True)
class Part:
    """What the footer of a part says."""

    task: str
    first: int
    rows: int
    colliding: int
    least_distance_m: float | None
    sha256: str


def path(folder: Path, shard: int) -> Path:
    """Return the file of a shard."""
    return folder / f"part-{shard:06}.parquet"


def write(file: Path, task: str, first: int, answers: Answers) -> Part:
    """Write a part: first under another name, which becomes its name when everything is on the disk."""
    pa, pq = imported("pyarrow", "pyarrow"), imported("pyarrow.parquet", "pyarrow")
    distance_m = answers.distance_m
    finite = distance_m[np.isfinite(distance_m)] if distance_m is not None else np.empty(0, np.float32)
    part = Part(
        task=task,
        first=first,
        rows=len(answers.collides),
        colliding=int(answers.collides.sum()),
        least_distance_m=float(finite.min()) if len(finite) else None,
        sha256=answers.sha256(first),
    )
    columns: dict[str, Any] = {
        "index": pa.array(np.arange(first, first + part.rows, dtype=np.int64)),
        "collides": pa.array(answers.collides),
    }
    if distance_m is not None:
        columns["distance_m"] = pa.array(distance_m)
        columns["a"] = pa.array(answers.a, pa.string()).dictionary_encode()
        columns["b"] = pa.array(answers.b, pa.string()).dictionary_encode()
    table = pa.table(columns)
    table = table.replace_schema_metadata({_KEY: json.dumps(asdict(part)).encode()})
    # Two workers may compute one shard, if a cluster takes one of them for dead: each has a name of its own.
    unfinished = file.with_name(f"{file.name}.{uuid.uuid4().hex}.tmp")
    encodings = {"index": "DELTA_BINARY_PACKED"}
    dictionaries = [name for name in ("a", "b") if name in columns]
    with unfinished.open("wb") as out:
        pq.write_table(table, out, compression="zstd", use_dictionary=dictionaries, column_encoding=encodings)
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
