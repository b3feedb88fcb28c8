"""Tables of numbers in NumPy files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArrayError, FileError


def read(file: Path, widths: tuple[int, ...] | None = None) -> npt.NDArray[np.float64]:
    """Return the `(N, width)` float64 values of a file that `numpy.save` has written, mapped into memory.

    Raises
    ------
    FileError
        If the file cannot be read.
    ArrayError
        If it has another type, shape or number of columns.
    """
    try:
        values: npt.NDArray[np.float64] = np.load(file, mmap_mode="r", allow_pickle=False)
        if not isinstance(values, np.ndarray):
            raise ValueError("several arrays")
    except (OSError, ValueError, EOFError) as error:
        hint = "a file that numpy.save has written"
        raise FileError(f"{file}: cannot be read: {error}\n  write: {hint}", str(file), None, str(error), hint) from error
    if values.ndim != 2 or values.dtype != np.float64 or (widths and values.shape[1] not in widths):
        wanted = " or ".join(f"(N, {width})" for width in widths) if widths else "(N, dof)"
        raise ArrayError(f"{file}: an array of {values.dtype} with shape {values.shape}\n  write: {wanted} of float64")
    return values


def finite(file: Path, values: npt.NDArray[np.float64], first: int = 0) -> npt.NDArray[np.float64]:
    """Copy rows of a file, of which the first has this number.

    Raises
    ------
    ArrayError
        If a number is not finite.
    """
    rows = np.array(values)
    if not np.isfinite(rows).all():
        row = first + int(np.argmin(np.isfinite(rows).all(axis=1)))
        raise ArrayError(f"{file}: row {row} has a number that is not finite\n  write: numbers, rad or m")
    return rows
