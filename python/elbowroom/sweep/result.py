"""The result of a sweep."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError, FileError
from elbowroom.sweep import bases, parts
from elbowroom.sweep.extras import imported
from elbowroom.sweep.parts import Part
from elbowroom.sweep.placement import Placement
from elbowroom.sweep.questions import Question

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MANIFEST = "manifest.json"

_WORDS = {"collides": "colliding", "within": "within", "solutions": "in reach", "free": "without contact"}


@dataclass(frozen=True)
class Result:
    """The result of a sweep.

    Attributes
    ----------
    folder
        The folder with the parts and `manifest.json`.
    rows
        Number of states, or of pairs of a place and a target.
    counts
        By column: number of rows in which it is not 0 or false.
    least
        By column of floats: the least finite value; `None` without one.
    sha256
        A hash of all answers, in hex: the same wherever and in whatever order shards of this size were computed.
    """

    folder: Path
    rows: int
    counts: dict[str, int]
    least: dict[str, float | None]
    sha256: str

    @staticmethod
    def load(folder: str | Path) -> Result:
        """Read the manifest of a finished sweep."""
        folder = Path(folder)
        table = _manifest(folder)
        try:
            return Result(folder, *(table[key] for key in ("rows", "counts", "least", "sha256")))
        except KeyError as error:
            raise _refused(folder, error) from error

    def batches(self) -> Iterator[dict[str, npt.NDArray[Any]]]:
        """Return the columns of one part after another, as NumPy arrays.

        Raises
        ------
        FileError
            If a part is missing or has other rows than the manifest says.
        """
        pq = imported("pyarrow.parquet", "pyarrow")
        for part in self.manifest()["parts"]:
            file = self.folder / part["file"]
            try:
                table = pq.read_table(file)
            except OSError as error:
                raise _broken(file, str(error)) from error
            if table.num_rows != part["rows"]:
                raise _broken(file, f"has {table.num_rows} rows, the manifest says {part['rows']}")
            yield {name: np.asarray(table[name].to_numpy()) for name in table.column_names}

    def manifest(self) -> dict[str, Any]:
        """Return `manifest.json`: the task, the columns with their units, and the parts."""
        return _manifest(self.folder)

    def placement(self) -> Placement:
        """Return what is reached from each place of the base.

        Raises
        ------
        ArgumentError
            If the sweep asked something else.
        """
        manifest = self.manifest()
        about = manifest["about"]
        if "base" not in about:
            raise ArgumentError("the sweep has no places of a base\n  write: a task with [reach] and [bases]")
        places = bases.of_manifest(manifest["task"]["states"]["bases"])
        return Placement.of(places.table(np.array(about["base"])), about["targets"], self.batches())

    def picture(self, file: str | Path | None = None, axes: tuple[str, str] | None = None) -> Figure:
        """Draw a map of the answers: over two joints, or over the places of the base.

        Parameters
        ----------
        file
            A PNG, SVG or PDF file to write.
        axes
            The names of two joints; default: the second and the third.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from elbowroom.sweep import pictures

        figure = pictures.draw(self, axes)
        if file is not None:
            figure.savefig(file, dpi=120)
        return figure

    def __str__(self) -> str:
        """Return some lines for people."""
        lines = [f"{self.rows:,} rows in {self.folder}"]
        for name, count in self.counts.items():
            lines.append(f"{_WORDS.get(name, name):<15} {count:,} ({100 * count / max(1, self.rows):.2f} %)")
        for name, value in self.least.items():
            if value is not None:
                lines.append(f"nearest         {1e3 * value:.3f} mm" if name == "distance_m" else f"least {name} {value:g}")
        return "\n  ".join([*lines, f"sha256          {self.sha256}"])


def _manifest(folder: Path) -> dict[str, Any]:
    try:
        table: dict[str, Any] = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        return table
    except (OSError, ValueError) as error:
        raise _refused(folder, error) from error


def _broken(file: Path, what: str) -> FileError:
    hint = "remove the part, and run the sweep again"
    return FileError(f"{file}: {what}\n  write: {hint}", str(file), None, what, hint)


def _refused(folder: Path, error: Exception) -> FileError:
    file, hint = folder / MANIFEST, "the folder of a finished sweep"
    return FileError(f"{file}: {error}\n  write: {hint}", str(file), None, str(error), hint)


def finish(folder: Path, identity: dict[str, Any], question: Question, found: list[Part]) -> Result:
    """Write the manifest of a sweep whose parts are all there."""
    found = sorted(found, key=lambda part: part.first)
    content = hashlib.sha256("".join(part.sha256 for part in found).encode()).hexdigest()
    counts: dict[str, int] = {}
    least: dict[str, float | None] = {}
    for part in found:
        for name, count in part.counts.items():
            counts[name] = counts.get(name, 0) + count
        for name, value in part.least.items():
            known = [v for v in (least.get(name), value) if v is not None]
            least[name] = min(known) if known else None
    result = Result(folder, sum(part.rows for part in found), counts, least, content)
    document = {
        "version": 1,
        "task": identity,
        "about": question.about(),
        "rows": result.rows,
        "counts": counts,
        "least": least,
        "sha256": content,
        "columns": {"index": "number of the row, from 0"} | question.units,
        "parts": [
            {"file": parts.path(folder, i).name, "first": p.first, "rows": p.rows, "counts": p.counts, "sha256": p.sha256}
            for i, p in enumerate(found)
        ],
    }
    unfinished = folder / f"{MANIFEST}.tmp"
    unfinished.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    unfinished.replace(folder / MANIFEST)
    return result
