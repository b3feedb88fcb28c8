"""What a sweep asks about a model: numbered rows, and the columns of their answers."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from elbowroom import _elbowroom
from elbowroom.errors import ArgumentError, ArrayError
from elbowroom.sweep.bases import Bases
from elbowroom.sweep.states import Random, States

#: A column of answers: an array of one dimension, or names.
Column: TypeAlias = npt.NDArray[Any] | list[str | None]
#: A function of a checker and `(N, dof)` states: columns with N values each, by name.
Function: TypeAlias = Callable[[_elbowroom.Checker, npt.NDArray[np.float64]], dict[str, Column]]

ASK = ("collision", "distance", "tolerance", "reach")

# Rows whose answers are compared to tell whether two models are one.
_PROBES = 256
_PROBED_TARGETS, _PROBED_PLACES = 64, 8


class Question(ABC):
    """A model, and what is asked about it. Any part of its rows can be answered alone."""

    #: The unit or meaning of every column that is known in advance.
    units: dict[str, str]

    @abstractmethod
    def count(self) -> int:
        """Return the number of rows."""

    @abstractmethod
    def answer(self, first: int, count: int) -> dict[str, Column]:
        """Answer `count` rows from number `first` on."""

    @abstractmethod
    def fingerprint(self) -> str:
        """Return a hash, in hex, of what the model answers about some rows of its own.

        A model is many files, on each machine. Two that answer alike to the bit are taken for one.
        """

    @abstractmethod
    def about(self) -> dict[str, Any]:
        """Return what a picture of the answers needs to know of the rows."""


class StateQuestion(Question):
    """A question about joint states."""

    def __init__(self, checker: _elbowroom.Checker, states: States, ask: str | Function, tolerance_m: float) -> None:
        """Ask about the states of a checker."""
        self._checker = checker
        self._states = states
        self._ask = ask
        self._tolerance_m = tolerance_m
        self.units = {
            "collision": {"collides": "bool"},
            "distance": {"collides": "bool", "distance_m": "m, rounded down to single precision", "a": "name", "b": "name"},
            "tolerance": {"within": f"bool: at most {tolerance_m} m apart"},
        }.get(ask if isinstance(ask, str) else "", {})

    def count(self) -> int:
        """Return the number of states."""
        return self._states.count(self._checker.limits)

    def answer(self, first: int, count: int) -> dict[str, Column]:
        """Answer `count` states from number `first` on."""
        q = self._states.rows(first, count, self._checker.limits)
        if callable(self._ask):
            return _checked(self._ask(self._checker, q), count)
        if self._ask == "collision":
            return {"collides": self._checker.collides(q)}
        if self._ask == "tolerance":
            return {"within": self._checker.within(q, self._tolerance_m)}
        found = self._checker.witness(q)
        distance_m = _rounded_down(found.distance_m)
        return {"collides": found.distance_m == 0.0, "distance_m": distance_m, "a": found.a, "b": found.b}

    def fingerprint(self) -> str:
        """Return a hash of distances, names and nearest points of random states."""
        checker = self._checker
        found = checker.witness(Random(_PROBES, 1).rows(0, _PROBES, checker.limits))
        names = [checker.joints, found.a, found.b]
        return _hash(names, (checker.limits, found.distance_m, found.point_a_m, found.point_b_m))

    def about(self) -> dict[str, Any]:
        """Return the joints and their limits."""
        return {"joints": self._checker.joints, "limits": self._checker.limits.tolist()}


class ReachQuestion(Question):
    """Whether a robot reaches targets from places of its base: a row for every target and place, the targets of a place together."""

    units = {"solutions": "joint states that bring the tool there", "free": "those in which the robot touches nothing"}

    def __init__(self, query: _elbowroom.ReachQuery, bases: Bases, targets: npt.NDArray[np.float64]) -> None:
        """Ask about targets of a robot."""
        self._query = query
        self._bases = bases
        self._targets = targets

    def count(self) -> int:
        """Return the number of places times that of targets."""
        return self._bases.count() * len(self._targets)

    def answer(self, first: int, count: int) -> dict[str, Column]:
        """Answer `count` rows from number `first` on."""
        found = [self._query.evaluate(self._targets[a:b], self._bases.pose(i, self._query.base)) for i, a, b in self._cut(first, count)]
        solutions = np.concatenate([np.empty(0, np.uint16), *(reach.solutions for reach in found)])
        return {"solutions": solutions, "free": np.concatenate([np.empty(0, np.uint16), *(reach.free for reach in found)])}

    def _cut(self, first: int, count: int) -> Iterable[tuple[int, int, int]]:
        """Return the places of rows, each with its first target and the one after its last."""
        targets = len(self._targets)
        for place in range(first // targets, -(-(first + count) // targets)):
            yield place, max(first - place * targets, 0), min(first + count - place * targets, targets)

    def fingerprint(self) -> str:
        """Return a hash of the joint values for some targets at some places."""
        targets = np.ascontiguousarray(self._targets[:: max(1, len(self._targets) // _PROBED_TARGETS)])
        last = self._bases.count() - 1
        chosen = sorted({round(last * k / max(1, _PROBED_PLACES - 1)) for k in range(_PROBED_PLACES)})
        places = [self._bases.pose(i, self._query.base) for i in chosen]
        found = [self._query.evaluate(targets, place) for place in places]
        values = [array for reach in found for array in (reach.solutions, reach.free, reach.q)]
        return _hash([self._query.joints], (self._query.base, self._targets, *values))

    def about(self) -> dict[str, Any]:
        """Return the number of targets, and the place of the base in the file."""
        return {"targets": len(self._targets), "base": self._query.base.tolist()}


def _checked(columns: dict[str, Column], count: int) -> dict[str, Column]:
    """Refuse columns that no part can hold."""
    if not isinstance(columns, dict) or not columns:
        raise ArgumentError(f"the function returned {columns!r:.40}\n  write: a dict of columns, {count} values each")
    return {name: _column(name, values, count) for name, values in columns.items()}


def _column(name: Any, values: Any, count: int) -> Column:
    if not isinstance(name, str) or name == "index":
        raise ArgumentError(f"{name!r} cannot name a column; `index` is the number of the row\n  write: another name")
    if isinstance(values, list) and all(value is None or isinstance(value, str) for value in values):
        names: list[str | None] = values
        shape: tuple[int, ...] = (len(names),)
        column: Column = names
    else:
        column = np.asarray(values)
        shape = column.shape
        if column.dtype.kind not in "bui" and column.dtype not in (np.float32, np.float64):
            raise ArrayError(f"the column `{name}` has the type {column.dtype}\n  write: numbers, bool, or a list of texts")
    if shape != (count,):
        raise ArrayError(f"the column `{name}` has the shape {shape}\n  write: one value for each of {count} states")
    return column


def _hash(names: list[Any], arrays: Iterable[npt.NDArray[Any]]) -> str:
    content = hashlib.sha256(json.dumps(names).encode())
    for values in arrays:
        content.update(np.ascontiguousarray(values).tobytes())
    return content.hexdigest()


def _rounded_down(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Return single precision: never farther apart than they are."""
    single = values.astype(np.float32)
    return np.where(single > values, np.nextafter(single, np.float32(-np.inf)), single).astype(np.float32)
