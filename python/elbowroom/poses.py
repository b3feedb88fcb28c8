"""Poses as NumPy arrays."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArrayError

__all__ = ["PoseLike", "matrix"]

#: A 4x4 array; `(xyz, quaternion)` in metres and as `x, y, z, w`; or `(xyz, rotation)` with an object that has `as_matrix`, such
#: as `scipy.spatial.transform.Rotation`.
PoseLike: TypeAlias = Any

_WANTED = "a 4x4 array, or (xyz in metres, quaternion xyzw), or (xyz, scipy Rotation)"


def _rotation(value: Any) -> npt.NDArray[np.float64]:
    if hasattr(value, "as_matrix"):
        return np.asarray(value.as_matrix(), dtype=np.float64)
    x, y, z, w = np.asarray(value, dtype=np.float64) / np.linalg.norm(value)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def matrix(pose: PoseLike) -> list[list[float]]:
    """Return a pose as four rows of four numbers.

    Parameters
    ----------
    pose
        A 4x4 array, `(xyz, quaternion xyzw)` or `(xyz, rotation)`; lengths in metres.

    Raises
    ------
    ArrayError
        If `pose` is none of these, or no rigid motion.

    Examples
    --------
    >>> matrix(([0.5, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]))[0]
    [1.0, 0.0, 0.0, 0.5]
    """
    try:
        if isinstance(pose, tuple) and len(pose) == 2:
            found = np.eye(4)
            found[:3, 3] = np.asarray(pose[0], dtype=np.float64)
            with np.errstate(all="ignore"):
                found[:3, :3] = _rotation(pose[1])
        else:
            found = np.asarray(pose, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArrayError(f"`pose`: {error}\n  write: {_WANTED}") from error
    if found.shape != (4, 4):
        raise ArrayError(f"`pose` has the shape {found.shape}\n  write: {_WANTED}")
    turn = found[:3, :3]
    is_rigid = np.allclose(turn.T @ turn, np.eye(3), atol=1e-6) and np.linalg.det(turn) > 0.0
    if not (np.isfinite(found).all() and is_rigid and np.allclose(found[3], [0.0, 0.0, 0.0, 1.0])):
        raise ArrayError(f"`pose` is no rotation with a translation\n  write: {_WANTED}")
    rows: list[list[float]] = found.tolist()
    return rows
