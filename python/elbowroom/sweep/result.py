"""The result of a sweep."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import FileError
from elbowroom.sweep import parts
from elbowroom.sweep.extras import imported
from elbowroom.sweep.parts import Part

MANIFEST = "manifest.json"


@dataclass(frozen=True)
class Result:
    """The result of a sweep.

    Attributes
    ----------
    folder
        The folder with the parts and `manifest.json`.
    rows, colliding
        Numbers of states, and of those in which something collides.
    least_distance_m
        The least distance of all states; `None` if it was not asked.
    sha256
        A hash of all answers, in hex: the same wherever and in whatever order shards of this size were computed.
    """

    folder: Path
    rows: int
    colliding: int
    least_distance_m: float | None
    sha256: str

    @staticmethod
    def load(folder: str | Path) -> Result:
        """Read the manifest of a finished sweep."""
        file = Path(folder) / MANIFEST
        try:
            table = json.loads(file.read_text(encoding="utf-8"))
            return Result(file.parent, *(table[key] for key in ("rows", "colliding", "least_distance_m", "sha256")))
        except (OSError, ValueError, KeyError, TypeError) as error:
            hint = "the folder of a finished sweep"
            raise FileError(f"{file}: {error}\n  write: {hint}", str(file), None, str(error), hint) from error

    def batches(self) -> Iterator[dict[str, npt.NDArray[Any]]]:
        """Return the columns of one part after another, as NumPy arrays."""
        pq = imported("pyarrow.parquet", "pyarrow")
        for file in sorted(self.folder.glob("part-*.parquet"), key=lambda file: (len(file.name), file.name)):
            table = pq.read_table(file)
            yield {name: np.asarray(table[name].to_numpy()) for name in table.column_names}

    def __str__(self) -> str:
        """Return three lines for people."""
        least = "" if self.least_distance_m is None else f"\n  nearest   {1e3 * self.least_distance_m:.3f} mm"
        share = 100 * self.colliding / max(1, self.rows)
        return f"{self.rows:,} states in {self.folder}\n  colliding {self.colliding:,} ({share:.2f} %){least}\n  sha256    {self.sha256}"


def finish(folder: Path, identity: dict[str, Any], found: list[Part]) -> Result:
    """Write the manifest of a sweep whose parts are all there."""
    found = sorted(found, key=lambda part: part.first)
    least = [part.least_distance_m for part in found if part.least_distance_m is not None]
    content = hashlib.sha256("".join(part.sha256 for part in found).encode()).hexdigest()
    rows, colliding = sum(part.rows for part in found), sum(part.colliding for part in found)
    result = Result(folder, rows, colliding, min(least) if least else None, content)
    units = {"index": "number of the state, from 0", "collides": "bool"}
    if identity["ask"] == "distance":
        units |= {"distance_m": "m, rounded down to single precision", "a": "name", "b": "name"}
    document = {
        "version": 1,
        "task": identity,
        "rows": rows,
        "colliding": colliding,
        "least_distance_m": result.least_distance_m,
        "sha256": content,
        "columns": units,
        "parts": [
            {"file": parts.path(folder, i).name, "first": p.first, "rows": p.rows, "colliding": p.colliding, "sha256": p.sha256}
            for i, p in enumerate(found)
        ],
    }
    unfinished = folder / f"{MANIFEST}.tmp"
    unfinished.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    unfinished.replace(folder / MANIFEST)
    return result
