"""Files that are written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from elbowroom.errors import FileError

__all__ = ["obj", "unwritable", "written"]


def written(path: Path, text: str) -> Path:
    """Write a text file, and return its path."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error) from error
    return path


def unwritable(path: Path, error: OSError) -> FileError:
    """Return the error of a file that cannot be written."""
    hint = "a file in a folder that exists and can be written to"
    return FileError(f"{path}: cannot be written: {error}\n  write: {hint}", str(path), None, str(error), hint)


def obj(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.int64]) -> bytes:
    """Return triangles as an OBJ file, whose numbers read back to the same bits."""
    lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist()]
    return "".join(lines).encode("ascii")
