"""Poses as NumPy arrays."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from elbowroom.columns import real
from elbowroom.errors import ArrayError

__all__ = ["PoseLike", "matrix", "row"]

#: A 4x4 array; `(xyz, quaternion)` in metres and as `x, y, z, w`; or `(xyz, rotation)` with an object that has `as_matrix`, such
#: as `scipy.spatial.transform.Rotation`.
PoseLike: TypeAlias = Any

_WANTED = "a 4x4 array, or (xyz in metres, quaternion xyzw), or (xyz, scipy Rotation)"


def _rotation(value: Any) -> npt.NDArray[np.float64]:
    if hasattr(value, "as_matrix"):
        return real(value.as_matrix())
    x, y, z, w = real(value) / np.linalg.norm(value)
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
            place = real(pose[0])
            if place.shape != (3,):
                raise ArrayError(f"`pose` has a place of shape {place.shape}\n  write: {_WANTED}")
            found[:3, 3] = place
            with np.errstate(all="ignore"):
                found[:3, :3] = _rotation(pose[1])
        else:
            found = real(pose)
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


def row(pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return x, y, z in metres and the quaternion x, y, z, w of a 4x4 array.

    Examples
    --------
    >>> row(np.eye(4)).tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    """
    turn = pose[:3, :3]
    # The largest of the four is computed from the diagonal, the others by it (Shepperd, 1978).
    squares = np.array([turn[0, 0], turn[1, 1], turn[2, 2], np.trace(turn)])
    k = int(np.argmax(squares))
    if k == 3:
        quaternion = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1], 1.0 + squares[3]])
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        quaternion = np.empty(4)
        quaternion[k] = 1.0 + 2.0 * squares[k] - squares[3]
        quaternion[i], quaternion[j] = turn[i, k] + turn[k, i], turn[j, k] + turn[k, j]
        quaternion[3] = turn[j, i] - turn[i, j]
    found: npt.NDArray[np.float64] = np.concatenate([pose[:3, 3], quaternion / np.linalg.norm(quaternion)])
    return found
