"""The places of a robot's base, for questions of reach."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError, ArrayError
from elbowroom.poses import matrix, row
from elbowroom.sweep.tables import finite, read

Pose = npt.NDArray[np.float64]
#: First value, last value, and how many, evenly spaced.
Axis = tuple[float, float, int]


class Bases(ABC):
    """A sequence of places. Poses are those of the root link in the world."""

    @abstractmethod
    def count(self) -> int:
        """Return the number of places."""

    @abstractmethod
    def pose(self, number: int, present: Pose) -> Pose:
        """Return a place as a 4x4 array, metres; `present` is the one of the model's file."""

    def table(self, present: Pose) -> npt.NDArray[np.float64]:
        """Return `(P, 7)`: x, y, z in metres and the quaternion x, y, z, w of every place."""
        return np.array([row(self.pose(i, present)) for i in range(self.count())]).reshape(-1, 7)

    def files(self) -> list[Path]:
        """Return the files that the places come from."""
        return []

    def check(self) -> None:
        """Refuse rows that are not poses."""


@dataclass(frozen=True)
class BaseGrid(Bases):
    """All combinations of evenly spaced coordinates and turns about the vertical axis; the turn changes fastest.

    Of a single value the middle between first and last is taken.

    Parameters
    ----------
    x_m, y_m, z_m
        Coordinates in the world, metres; without them those of the file.
    yaw_rad
        Turn from the orientation of the file about the world's z axis.
    """

    x_m: Axis | None = None
    y_m: Axis | None = None
    z_m: Axis | None = None
    yaw_rad: Axis = (0.0, 0.0, 1)

    def __post_init__(self) -> None:
        """Refuse axes that are not possible."""
        for name, axis in vars(self).items():
            if axis is None:
                continue
            is_axis = isinstance(axis, tuple) and len(axis) == 3 and type(axis[2]) is int and 0 < axis[2] < 2**31
            if not (is_axis and all(isinstance(v, (int, float)) and math.isfinite(v) for v in axis[:2])):
                raise ArgumentError(f"`{name}` is {axis!r}\n  write: first value, last value and how many, as {name} = [-1.0, 1.0, 11]")

    def _shape(self) -> tuple[int, ...]:
        return tuple(axis[2] if axis else 1 for axis in (self.x_m, self.y_m, self.z_m, self.yaw_rad))

    def count(self) -> int:
        """Return the product of the numbers of values."""
        return math.prod(self._shape())

    def pose(self, number: int, present: Pose) -> Pose:
        """Return a place."""
        places = np.unravel_index(number, self._shape())
        pose = np.array(present)
        for k, axis in enumerate((self.x_m, self.y_m, self.z_m)):
            if axis:
                pose[k, 3] = _value(axis, int(places[k]))
        yaw = _value(self.yaw_rad, int(places[3]))
        cos, sin = math.cos(yaw), math.sin(yaw)
        pose[:3, :3] = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ pose[:3, :3]
        return pose


@dataclass(frozen=True)
class BaseTable(Bases):
    """The rows of a NumPy file with `(P, 7)` float64: x, y, z in metres and the quaternion x, y, z, w."""

    file: Path

    def count(self) -> int:
        """Return the number of rows."""
        return len(read(self.file, (7,)))

    def pose(self, number: int, present: Pose) -> Pose:
        """Return a row as a pose."""
        row = np.array(read(self.file, (7,))[number])
        return np.array(matrix((row[:3], row[3:])))

    def files(self) -> list[Path]:
        """Return the file."""
        return [self.file]

    def check(self) -> None:
        """Refuse rows that are not poses."""
        rows = finite(self.file, read(self.file, (7,)))
        zero = np.flatnonzero(np.linalg.norm(rows[:, 3:], axis=1) < 1e-9)
        if len(zero):
            raise ArrayError(f"{self.file}: row {zero[0]} has a quaternion of length 0\n  write: one of length 1")


def of_manifest(bases: dict[str, Any]) -> Bases:
    """Return the places that the manifest of a sweep names."""
    fields = {key: tuple(value) if isinstance(value, list) else value for key, value in bases.items() if key != "kind"}
    return BaseTable(Path(bases["file"])) if bases["kind"] == "basetable" else BaseGrid(**fields)


def _value(axis: Axis, place: int) -> float:
    first, last, count = axis
    # A single value is the middle.
    return first + (last - first) * (place / (count - 1) if count > 1 else 0.5)
