"""Arguments as arrays of numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArrayError

__all__ = ["columns", "numbers", "real", "split", "state"]


def real(value: Any) -> npt.NDArray[np.float64]:
    """Return an argument as an array; complex numbers, whose imaginary parts NumPy drops, are a `TypeError`."""
    if np.iscomplexobj(value):
        raise TypeError("complex numbers")
    return np.asarray(value, dtype=np.float64)


def columns(first: npt.ArrayLike, second: npt.ArrayLike) -> tuple[npt.NDArray[np.float64], tuple[int, ...]]:
    """Return two arguments, broadcast, as `(N, 2)`, and their shape."""
    try:
        a, b = np.broadcast_arrays(real(first), real(second))
    except (TypeError, ValueError) as error:
        raise ArrayError(f"the arguments: {error}\n  write: numbers, or arrays whose shapes fit") from error
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise ArrayError("an argument has values that are not finite\n  write: finite numbers")
    return np.stack([a.ravel(), b.ravel()], axis=1), a.shape


def split(rows: npt.NDArray[np.float64], shape: tuple[int, ...]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the columns of `(N, 2)`, each in a shape."""
    return rows[:, 0].reshape(shape), rows[:, 1].reshape(shape)


def numbers(name: str, values: Any, dimensions: int, shape: str) -> npt.NDArray[np.float64]:
    """Return a copy of an argument that is an array of finite numbers; `shape` is for the message."""
    try:
        given = np.array(values)
        is_real = np.issubdtype(given.dtype, np.number) and not np.iscomplexobj(given)
        found = given.astype(np.float64) if is_real else None
    except (TypeError, ValueError):
        found = None
    if found is None or found.ndim != dimensions or not np.isfinite(found).all():
        raise ArrayError(f"`{name}` is not an array of finite numbers of shape {shape}\n  write: one, in seconds, rad and metres")
    return found


def state(q: Any, joints: list[str]) -> npt.NDArray[np.float64]:
    """Return a state of these joints."""
    found = numbers("q", q, 1, f"({len(joints)},)")
    if len(found) != len(joints):
        raise ArrayError(f"`q` has {len(found)} values\n  write: {len(joints)}: {', '.join(joints)}")
    return found
