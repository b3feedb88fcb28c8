"""The states of a sweep: a fixed sequence, any part of which can be made alone."""

from __future__ import annotations

import math
import warnings
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError, ArrayError
from elbowroom.sweep.extras import imported
from elbowroom.sweep.tables import finite, read

Values = npt.NDArray[np.float64]

# SciPy cannot jump ahead in longer sequences.
_SOBOL_BITS = 32

# Joints without limits turn once.
_TURN = np.pi


def ranges(limits: Values) -> Values:
    """Replace the limits of joints that have none."""
    return np.column_stack([np.where(np.isfinite(limits[:, k]), limits[:, k], (2 * k - 1) * _TURN) for k in (0, 1)])


class States(ABC):
    """A sequence of joint states."""

    @abstractmethod
    def count(self, limits: Values) -> int:
        """Return the number of states."""

    @abstractmethod
    def rows(self, first: int, count: int, limits: Values) -> Values:
        """Return `(count, dof)` states from number `first` on; they do not depend on how the sequence is cut."""

    def files(self) -> list[Path]:
        """Return the files that the states come from."""
        return []


@dataclass(frozen=True)
class Sequence(States):
    """So many states between the limits, from a seed."""

    number: int
    seed: int = 1

    def __post_init__(self) -> None:
        """Refuse numbers that are not possible."""
        if not (0 <= self.number < 2**63 and 0 <= self.seed < 2**63):
            raise ArgumentError(f"{self.number} states with the seed {self.seed}\n  write: whole numbers of 0 or more")

    def count(self, limits: Values) -> int:
        """Return the number of states."""
        return self.number


@dataclass(frozen=True)
class Random(Sequence):
    """Uniform between the limits: number `i` is the same in every sweep with this seed."""

    def rows(self, first: int, count: int, limits: Values) -> Values:
        """Return states by their numbers: Philox counts, so any state can be made without those before it."""
        low, high = ranges(limits).T
        dof = len(limits)
        # A step of the counter gives four numbers.
        steps = -(-dof // 4)
        source = np.random.Philox(key=self.seed)
        source.advance(first * steps)
        unit = np.random.Generator(source).random((count, 4 * steps))[:, :dof]
        return np.ascontiguousarray(low + unit * (high - low))


@dataclass(frozen=True)
class Sobol(Sequence):
    """A scrambled Sobol sequence between the limits, which fills the space more evenly than random states."""

    def count(self, limits: Values) -> int:
        """Return the number of states."""
        if self.number > 2**_SOBOL_BITS:
            text = f"a Sobol sequence has at most {2**_SOBOL_BITS} states, not {self.number}\n  write: kind = \"random\""
            raise ArgumentError(text)
        return super().count(limits)

    def rows(self, first: int, count: int, limits: Values) -> Values:
        """Return states by their numbers."""
        qmc = imported("scipy.stats.qmc", "SciPy")
        low, high = ranges(limits).T
        sequence = qmc.Sobol(len(limits), scramble=True, bits=_SOBOL_BITS, rng=np.random.default_rng(self.seed))
        if first > 0:
            sequence.fast_forward(first)
        with warnings.catch_warnings():
            # Only the whole sequence could be balanced, not a part of it.
            warnings.simplefilter("ignore", UserWarning)
            unit = sequence.random(count)
        return np.ascontiguousarray(low + unit * (high - low))


@dataclass(frozen=True)
class Grid(States):
    """All combinations of evenly spaced values of each joint, the limits included; the last joint changes fastest."""

    steps: tuple[int, ...]

    def count(self, limits: Values) -> int:
        """Return the product of the numbers of values."""
        if len(self.steps) != len(limits):
            text = f"`steps` has {len(self.steps)} numbers, the model {len(limits)} joints\n  write: one number for each joint"
            raise ArgumentError(text)
        count = math.prod(self.steps)
        if count >= 2**63:
            raise ArgumentError(f"the grid has {count} states\n  write: fewer values of each joint")
        return count

    def rows(self, first: int, count: int, limits: Values) -> Values:
        """Return states by their numbers."""
        low, high = ranges(limits).T
        steps = np.array(self.steps)
        places = np.column_stack(np.unravel_index(np.arange(first, first + count), self.steps))
        # A single value is the middle.
        share = np.where(steps > 1, places / np.maximum(steps - 1, 1), 0.5)
        return np.ascontiguousarray(low + share * (high - low))


@dataclass(frozen=True)
class Table(States):
    """The rows of a NumPy file with `(N, dof)` float64."""

    file: Path

    def count(self, limits: Values) -> int:
        """Return the number of rows."""
        rows, columns = read(self.file).shape
        if columns != len(limits):
            text = f"{self.file}: {columns} columns, the model has {len(limits)} joints\n  write: one column for each joint"
            raise ArrayError(text)
        return int(rows)

    def rows(self, first: int, count: int, limits: Values) -> Values:
        """Return rows of the file."""
        return finite(self.file, read(self.file)[first : first + count], first)

    def files(self) -> list[Path]:
        """Return the file."""
        return [self.file]
