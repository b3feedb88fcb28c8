"""Trajectories: joint values over time."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from elbowroom import _elbowroom
from elbowroom.columns import numbers, real
from elbowroom.errors import ArgumentError, ArrayError, FileError
from elbowroom.files import written

__all__ = ["Trajectory"]

_Numbers = npt.NDArray[np.float64]


class Trajectory:
    """Joint values at increasing times, linear between them, at rest before the first and after the last.

    Parameters
    ----------
    times_s
        `(N,)`: the times, each later than the one before.
    q
        `(N, dof)`: a state per time, rad or m.
    joints
        The names of the joints, in the order of the values.

    Examples
    --------
    >>> import elbowroom as er
    >>> there = er.Trajectory.time_optimal([[0, 0], [1, 0], [1, 1]], velocity=1.0, acceleration=4.0, jerk=40.0, blend=0.2)
    >>> round(there.duration_s, 2), there.at(there.duration_s).round(9).tolist()
    (2.49, [1.0, 1.0])
    """

    __slots__ = ("joints", "q", "times_s")

    def __init__(self, times_s: npt.ArrayLike, q: npt.ArrayLike, joints: Iterable[str] | None = None) -> None:
        """Copy the arrays."""
        #: `(N,)`: the times in seconds.
        self.times_s = _numbers("times_s", times_s, 1)
        #: `(N, dof)`: the states, rad or m.
        self.q = _numbers("q", q, 2)
        if len(self.times_s) != len(self.q) or not len(self.q):
            rows = f"{len(self.times_s)} times and {len(self.q)} states"
            raise ArrayError(f"the trajectory has {rows}\n  write: as many times as states, at least one")
        later = np.diff(self.times_s) > 0.0
        if not later.all():
            row = int(np.argmin(later)) + 1
            raise ArrayError(f"`times_s`: row {row} is not later than the one before\n  write: increasing times, seconds")
        #: The names of the joints.
        self.joints = _default_names(self.q.shape[1]) if joints is None else list(joints)
        if len(self.joints) != self.q.shape[1]:
            raise ArgumentError(f"{len(self.joints)} names of {self.q.shape[1]} joints\n  write: a name per column of `q`")
        for name in self.joints:
            if not isinstance(name, str) or not name or name.strip() != name or set(name) & set(',"\r\n'):
                raise ArgumentError(f"a joint is called {name!r}\n  write: names without commas, quotes and ends of lines")
        if len(set(self.joints)) != len(self.joints):
            raise ArgumentError(f"two joints have the same name: {', '.join(self.joints)}\n  write: names that differ")

    @classmethod
    def time_optimal(
        cls,
        waypoints: npt.ArrayLike,
        *,
        velocity: npt.ArrayLike,
        acceleration: npt.ArrayLike,
        jerk: npt.ArrayLike,
        blend: float = 0.0,
        period_s: float = 0.004,
        joints: Iterable[str] | None = None,
    ) -> Trajectory:
        """Compute the fastest motion along waypoints within limits, at rest at both ends.

        Between the waypoints it is straight in joint space. What it may touch at blended corners is not tested: `Checker.edges`
        with the rows of the result does that, and `Planner.plan` returns motions that are proven.

        Parameters
        ----------
        waypoints
            `(K, dof)`, rad or m.
        velocity, acceleration, jerk
            The largest ones, per s, s² and s³: a number, or one per joint.
        blend
            The largest distance from a corner at which its curve begins, the norm over all joints; 0: the motion rests there.
        period_s
            Time between rows.
        joints
            The names of the joints.
        """
        points = _numbers("waypoints", waypoints, 2)
        dof = points.shape[1]
        names = _default_names(dof) if joints is None else list(joints)
        rates = [_per_joint(name, value, dof) for name, value in (("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk))]
        distance = _number("blend", blend, "rad or m, 0 or more")
        if not distance >= 0.0:
            raise ArgumentError(f"`blend` is {blend}\n  write: rad or m, 0 or more")
        times_s, q = _elbowroom.time_optimal(points, names, rates, distance, _number("period_s", period_s, "seconds above 0"))
        return cls(times_s, q, names)

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Trajectory:
        """Read a CSV file: `t_s`, and a column per joint, as `save` and `elbowroom plan` write it."""
        path = Path(file)

        def refused(line: int | None, message: str, hint: str) -> FileError:
            place = f"{path}:{line}" if line else str(path)
            return FileError(f"{place}: {message}\n  write: {hint}", str(path), line, message, hint)

        try:
            lines = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
        except (OSError, UnicodeDecodeError) as error:
            raise refused(None, f"cannot be read: {error}", "a CSV file with the columns t_s and one per joint") from error
        header = [name.strip() for name in lines[0]] if lines else []
        if header[:1] != ["t_s"] or len(header) < 2:
            raise refused(1, "does not begin with the names of the columns", "t_s,joint_1,joint_2")
        rows = []
        for line, row in enumerate(lines[1:], start=2):
            if not row:
                continue
            try:
                rows.append([float(value) for value in row])
            except ValueError as error:
                raise refused(line, str(error), "numbers: seconds, and rad or m") from error
            if len(row) != len(header) or not np.isfinite(rows[-1]).all():
                raise refused(line, f"has {len(row)} values", f"{len(header)} finite numbers: {', '.join(header)}")
            if len(rows) > 1 and rows[-1][0] <= rows[-2][0]:
                raise refused(line, "is not later than the row before", "increasing times, seconds")
        if not rows:
            raise refused(len(lines), "has no row", "at least one row below the names of the columns")
        values = np.array(rows)
        return cls(values[:, 0], values[:, 1:], header[1:])

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Write a CSV file, which `trajectory = "…"` of a program in a cell file takes; its numbers read back to the same bits."""
        path = Path(file)
        lines = [",".join(["t_s", *self.joints])]
        lines += [",".join(map(repr, [t_s, *q])) for t_s, q in zip(self.times_s.tolist(), self.q.tolist(), strict=True)]
        return written(path, "\n".join([*lines, ""]))

    @property
    def duration_s(self) -> float:
        """The time from the first row to the last."""
        return float(self.times_s[-1] - self.times_s[0])

    def at(self, times_s: npt.ArrayLike) -> _Numbers:
        """Return the states at times: `(dof,)` for a number, `(K, dof)` for an array."""
        try:
            times = real(times_s)
        except (TypeError, ValueError) as error:
            raise ArrayError(f"`times_s`: {error}\n  write: seconds") from error
        if not np.isfinite(times).all():
            raise ArrayError("`times_s` has values that are not finite\n  write: seconds")
        columns = [np.interp(times, self.times_s, column) for column in self.q.T]
        return np.stack(columns, axis=-1)

    def velocities(self) -> _Numbers:
        """Return the velocity between each row and the next, `(N - 1, dof)`, rad/s or m/s."""
        found: _Numbers = np.diff(self.q, axis=0) / np.diff(self.times_s)[:, None]
        return found

    def resampled(self, period_s: float) -> Trajectory:
        """Return the trajectory at every `period_s`, and at its end."""
        period = _number("period_s", period_s, "seconds above 0")
        if not 0.0 < period < float("inf"):
            raise ArgumentError(f"`period_s` is {period_s}\n  write: seconds above 0")
        first, last = float(self.times_s[0]), float(self.times_s[-1])
        count = (last - first) / period
        if not count < 5e6:
            raise ArgumentError(f"`period_s` is {period_s}\n  write: a period with at most 5,000,000 rows")
        times = first + period * np.arange(int(np.floor(count * (1 - 1e-12))) + 1)
        times = np.append(times[times < last], last)
        return Trajectory(times, self.at(times), self.joints)

    def ordered(self, joints: Iterable[str]) -> Trajectory:
        """Return the trajectory with the joints in another order; one whose joints were not named has them in this order already."""
        names = list(joints)
        if not all(isinstance(name, str) for name in names):
            raise ArgumentError(f"the names are {names!r}\n  write: names of joints")
        if sorted(names) == sorted(self.joints):
            return Trajectory(self.times_s, self.q[:, [self.joints.index(name) for name in names]], names)
        if len(names) == len(self.joints) and self.joints == _default_names(len(names)):
            return Trajectory(self.times_s, self.q, names)
        raise ArgumentError(f"the trajectory is of {', '.join(self.joints)}\n  write: one of {', '.join(names)}")

    def reversed(self) -> Trajectory:
        """Return the way back, over the same times."""
        return Trajectory((self.times_s[0] + self.times_s[-1]) - self.times_s[::-1], self.q[::-1], self.joints)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.times_s)

    def __eq__(self, other: object) -> bool:
        """Return whether times, states and names are the same."""
        if not isinstance(other, Trajectory):
            return NotImplemented
        same = np.array_equal(self.times_s, other.times_s) and np.array_equal(self.q, other.q)
        return same and self.joints == other.joints

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Say how long it is."""
        return f"Trajectory({len(self)} rows, {self.duration_s:g} s, {len(self.joints)} joints)"


def _default_names(dof: int) -> list[str]:
    return [f"joint_{index + 1}" for index in range(dof)]


def _numbers(name: str, values: Any, dimensions: int) -> _Numbers:
    found = numbers(name, values, dimensions, "(N,)" if dimensions == 1 else "(N, dof)")
    found.flags.writeable = False
    return found


def _number(name: str, value: Any, wanted: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"`{name}` is {value!r}\n  write: {wanted}") from error


def _per_joint(name: str, value: npt.ArrayLike, dof: int) -> list[float]:
    try:
        rates = np.broadcast_to(real(value), (dof,))
    except (TypeError, ValueError) as error:
        raise ArrayError(f"`{name}`: {error}\n  write: a number, or one per joint") from error
    if not (np.isfinite(rates).all() and (rates > 0.0).all()):
        raise ArgumentError(f"`{name}` is {value!r}\n  write: finite numbers above 0")
    found: list[float] = rates.tolist()
    return found
