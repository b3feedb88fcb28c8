"""Pickling: a model is its files, so a pickle has their paths, and the checksum of the first one.

A worker on another machine needs the same files at the same paths. If a file has changed since, unpickling fails: two
models that differ must not be taken for one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from elbowroom import _elbowroom
from elbowroom.errors import FileError

_Reduced = tuple[Callable[..., Any], tuple[Any, ...]]


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file in hex."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        hint = "the same file at the same path wherever the object is pickled or loaded; that of a Scene lasts once it is saved"
        raise FileError(f"{path}: cannot be read: {error}\n  write: {hint}", str(path), None, str(error), hint) from error


def _same(path: Path, expected: str) -> None:
    if checksum(path) != expected:
        message = "has changed since the object was pickled"
        hint = "load it again, and pickle the new object"
        raise FileError(f"{path}: {message}\n  write: {hint}", str(path), None, message, hint)


def robot(files: tuple[Any, ...], expected: str) -> _elbowroom.Robot:
    """Load a pickled robot."""
    path, srdf, unit, joints = files
    _same(path, expected)
    return _elbowroom.Robot.load(path, srdf, unit=unit, joints=joints)


def cell(path: Path, expected: str) -> _elbowroom.Cell:
    """Load a pickled cell."""
    _same(path, expected)
    return _elbowroom.Cell.load(path)


def checker(source: Any, level: str, between: str | None, threads: int | None) -> _elbowroom.Checker:
    """Make a pickled checker."""
    return _elbowroom.Checker(source, level=level, between=between, threads=threads)


def files_of_robot(model: _elbowroom.Robot) -> tuple[Any, ...]:
    """Return the file of a robot, its SRDF, its unit of length and the file of its joints; `None` where it has none."""
    files: tuple[Any, ...] = model.__reduce__()[1][0]
    return files


def reduced_robot(files: tuple[Any, ...]) -> _Reduced:
    """Return what a pickle of a robot has."""
    return robot, (files, checksum(files[0]))


def reduced_cell(path: Path) -> _Reduced:
    """Return what a pickle of a cell has."""
    return cell, (path, checksum(path))


def reduced_checker(source: Any, level: str, between: str | None, threads: int | None) -> _Reduced:
    """Return what a pickle of a checker has."""
    return checker, (source, level, between, threads)


def reach(source: Any, robot: str | None, turns: int, threads: int | None) -> _elbowroom.ReachQuery:
    """Make a pickled query of reach."""
    return _elbowroom.ReachQuery(source, robot, turns=turns, threads=threads)


def reduced_reach(source: Any, robot: str | None, turns: int, threads: int | None) -> _Reduced:
    """Return what a pickle of a query of reach has."""
    return reach, (source, robot, turns, threads)


def planner(source: Any, robot: str, kind: str, clearance_m: float) -> _elbowroom.Planner:
    """Make a pickled planner."""
    return _elbowroom.Planner(source, robot, planner=kind, clearance_m=clearance_m)


def reduced_planner(source: Any, robot: str, kind: str, clearance_m: float) -> _Reduced:
    """Return what a pickle of a planner has."""
    return planner, (source, robot, kind, clearance_m)
