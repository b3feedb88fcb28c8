"""The task of a sweep: what is asked about which states of which model."""

from __future__ import annotations

import hashlib
import json
import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom import _elbowroom
from elbowroom.errors import ArgumentError, ArrayError, FileError
from elbowroom.sweep.bases import BaseGrid, Bases, BaseTable
from elbowroom.sweep.functions import name_of
from elbowroom.sweep.questions import ASK, Function, Question, ReachQuestion, StateQuestion
from elbowroom.sweep.states import Grid, Random, Sobol, States, Table
from elbowroom.sweep.tables import finite, read

_KEYS = (
    "version", "cell", "robot", "srdf", "ask", "tolerance_m", "level", "between", "shard_rows", "executor", "out", "states", "reach",
    "bases",
)  # fmt: skip
_TEXTS = ("cell", "robot", "srdf", "ask", "level", "between", "executor", "out")
_EXECUTORS = ("local", "ray")
_LARGEST_SHARD = 10_000_000


@dataclass(frozen=True)
class Placements:
    """Targets that a robot shall reach from places of its base.

    Parameters
    ----------
    bases
        The places: `BaseGrid` or `BaseTable` of `elbowroom.sweep.bases`.
    targets
        NumPy file of targets: `(N, 7)` or `(N, 6)` as for `elbowroom.ReachQuery.evaluate`.
    robot, turns
        As for `elbowroom.ReachQuery`.
    """

    bases: Bases
    targets: str | Path
    robot: str | None = None
    turns: int = 1

    def files(self) -> list[Path]:
        """Return the files of targets and places."""
        return [Path(self.targets), *self.bases.files()]

    def rows(self) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Read and check the targets and the places.

        Raises
        ------
        ArrayError
            If a row is not a target or not a place.
        """
        file = Path(self.targets)
        targets = np.ascontiguousarray(finite(file, read(file, (6, 7))))
        zero = np.flatnonzero(np.linalg.norm(targets[:, 3:], axis=1) < 1e-9)
        if len(zero):
            what = "direction" if targets.shape[1] == 6 else "quaternion"
            raise ArrayError(f"{file}: row {zero[0]} has a {what} of length 0\n  write: one of length 1")
        self.bases.check()
        if not (len(targets) and self.bases.count()):
            raise ArgumentError("there is no target or no place of the base\n  write: one or more of each")
        return targets


@dataclass(frozen=True)
class Task:
    """What is asked about which states of which model.

    Parameters
    ----------
    model
        A cell file, or the file of a robot.
    states
        The states: `Random`, `Sobol`, `Grid` or `Table` of `elbowroom.sweep.states`; or `Placements` of a robot.
    out
        Folder of the parts and the manifest.
    is_cell
        Whether `model` is a cell file.
    srdf
        Pairs of a robot that are not compared.
    ask
        `"collision"`; `"distance"`, which also names the nearest pair; `"tolerance"`; or a function of a `Checker` and `(N, dof)`
        states that returns columns of N values by name. On a cluster it is pickled. Of placements it is always `"reach"`.
    tolerance_m
        The distance of `"tolerance"`, metres.
    level, between
        As for `elbowroom.Checker`.
    shard_rows
        Number of states per part.
    executor
        `"local"`, or `"ray"`.
    """

    model: str | Path
    states: States | Placements
    out: str | Path
    is_cell: bool = True
    srdf: str | Path | None = None
    ask: str | Function | None = None
    tolerance_m: float = 0.0
    level: str = "auto"
    between: str | None = None
    shard_rows: int = 100_000
    executor: str = "local"

    def __post_init__(self) -> None:
        """Refuse values that are not possible."""
        if not callable(self.asked):
            _chosen("ask", self.asked, ASK)
        if isinstance(self.states, Placements) != (self.asked == "reach"):
            raise ArgumentError('`ask` does not fit\n  write: ask = "reach" with placements, something else with states')
        if self.asked == "reach" and (self.between, self.level, self.tolerance_m) != (None, "auto", 0.0):
            raise ArgumentError("`between`, `level` and `tolerance_m` do not fit\n  write: none of them with [reach]")
        if not (0.0 <= self.tolerance_m < math.inf):
            raise ArgumentError(f"`tolerance_m` is {self.tolerance_m}\n  write: metres, 0 or more, as 0.02")
        _chosen("executor", self.executor, _EXECUTORS)
        if not 1 <= self.shard_rows <= _LARGEST_SHARD:
            text = f"`shard_rows` is {self.shard_rows}\n  write: a number of states from 1 to {_LARGEST_SHARD}, as 100000"
            raise ArgumentError(text)

    @staticmethod
    def load(path: str | Path) -> Task:
        """Read a task from a TOML file; its paths are relative to the file.

        Raises
        ------
        FileError
            If the file cannot be read, or a key or value is not known.
        """
        file = Path(path)
        try:
            table = tomllib.loads(file.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise _refused(file, str(error), "a TOML file with `cell` and [states]") from error
        try:
            return _of_table(table, file.resolve().parent, file.stem)
        except ArgumentError as error:
            message, _, hint = str(error).partition("\n  write: ")
            raise _refused(file, message, hint) from error

    @property
    def asked(self) -> str | Function:
        """What is asked."""
        return self.ask or ("reach" if isinstance(self.states, Placements) else "distance")

    def question(self, threads: int | None = None) -> Question:
        """Load the model."""
        source: _elbowroom.Cell | _elbowroom.Robot
        source = _elbowroom.Cell.load(self.model) if self.is_cell else _elbowroom.Robot.load(self.model, self.srdf)
        if isinstance(self.states, Placements):
            placed = self.states
            query = _elbowroom.ReachQuery(source, placed.robot, turns=placed.turns, threads=threads)
            return ReachQuestion(query, placed.bases, placed.rows())
        checker = _elbowroom.Checker(source, level=self.level, between=self.between, threads=threads)
        return StateQuestion(checker, self.states, self.asked, self.tolerance_m)

    def fingerprint(self, question: Question) -> str:
        """Return a hash, in hex, of the files of the model that the task names, and of what it answers."""
        files = [checksum(Path(file)) for file in (self.model, self.srdf) if file is not None]
        return hashlib.sha256(" ".join([*files, question.fingerprint()]).encode()).hexdigest()

    def identity(self, question: Question) -> dict[str, Any]:
        """Return what the answers depend on. Parts of one sweep have the same; where the work is done does not count."""
        return {
            "elbowroom": _elbowroom.__version__,
            "model": Path(self.model).name,
            "fingerprint": self.fingerprint(question),
            "files": [checksum(file) for file in self.states.files()],
            "states": _plain(self.states),
            "ask": self.asked if isinstance(self.asked, str) else name_of(self.asked),
            "tolerance_m": self.tolerance_m,
            "level": self.level,
            "between": self.between,
            "shard_rows": self.shard_rows,
        }


def _plain(states: Any) -> Any:
    """Return states as JSON has them."""
    if isinstance(states, Path):
        return str(states)
    if isinstance(states, (States, Placements, Bases)):
        fields = {key: _plain(value) for key, value in vars(states).items()}
        return {"kind": type(states).__name__.lower(), **fields}
    return states


def digest(identity: dict[str, Any]) -> str:
    """Return the SHA-256 of an identity in hex."""
    return hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()


def checksum(file: Path) -> str:
    """Return the SHA-256 of a file in hex."""
    with _opened(file) as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def _opened(file: Path) -> BufferedReader:
    try:
        return file.open("rb")
    except OSError as error:
        raise _refused(file, f"cannot be read: {error}", "a file that is there") from error


def _refused(file: Path, message: str, hint: str) -> FileError:
    return FileError(f"{file}: {message}\n  write: {hint}", str(file), None, message, hint)


def _chosen(key: str, value: Any, known: tuple[str, ...]) -> None:
    if value not in known:
        raise ArgumentError(f"`{key}` is {value!r}\n  write: one of {', '.join(known)}")


def _known(table: dict[str, Any], known: tuple[str, ...], where: str) -> None:
    for key in table:
        if key not in known:
            raise ArgumentError(f"`{key}` is not a key of {where}\n  write: one of {', '.join(known)}")


def _of_table(table: dict[str, Any], folder: Path, name: str) -> Task:
    _known(table, _KEYS, "a task")
    if table.get("version", 1) != 1:
        raise ArgumentError(f"`version` is {table['version']!r}\n  write: version = 1")
    if ("cell" in table) == ("robot" in table):
        raise ArgumentError('the model is missing, or there are two\n  write: cell = "cell.toml", or robot = "arm.urdf"')
    text = {key: _text(table, key) for key in _TEXTS}
    srdf = text["srdf"]
    if srdf and "cell" in table:
        raise ArgumentError("`srdf` belongs to a robot\n  write: srdf = \"arm.srdf\" in the cell file, below [robot.NAME]")
    return Task(
        model=folder / str(text["cell"] or text["robot"]),
        states=_rows(table, folder),
        out=folder / (text["out"] or f"{name}-sweep"),
        is_cell="cell" in table,
        srdf=folder / srdf if srdf else None,
        ask=text["ask"],
        tolerance_m=_number(table, "tolerance_m"),
        level=text["level"] or "auto",
        between=text["between"],
        shard_rows=_whole(table, "shard_rows", 100_000),
        executor=text["executor"] or "local",
    )


def _text(table: dict[str, Any], key: str) -> str | None:
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise ArgumentError(f"`{key}` is {value!r}\n  write: a text in quotation marks")
    return value


def _number(table: dict[str, Any], key: str) -> float:
    value = table.get(key, 0.0)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise ArgumentError(f"`{key}` is {value!r}\n  write: a number, as {key} = 0.02")
    return float(value)


def _whole(table: dict[str, Any], key: str, default: int | None = None) -> int:
    value = table.get(key, default)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise ArgumentError(f"`{key}` is {value!r}\n  write: a whole number, as {key} = 1000")
    return value


def _rows(table: dict[str, Any], folder: Path) -> States | Placements:
    """Return what the rows are: states, or placements."""
    tables = {key: table[key] for key in ("states", "reach", "bases") if key in table}
    if not all(isinstance(value, dict) for value in tables.values()):
        raise ArgumentError("`states`, `reach` and `bases` are tables\n  write: [states]")
    if set(tables) == {"states"}:
        return _states(tables["states"], folder)
    if set(tables) != {"reach", "bases"}:
        text = 'the states are missing, or there is something else too\n  write: [states] with kind = "random" and rows = 1000000;'
        raise ArgumentError(f"{text} or [reach] with targets = \"spots.npy\", and [bases]")
    reach = tables["reach"]
    _known(reach, ("robot", "targets", "turns"), "[reach]")
    targets = _text(reach, "targets")
    if targets is None:
        raise ArgumentError('`targets` is missing\n  write: targets = "spots.npy", which numpy.save has written')
    return Placements(_bases(tables["bases"], folder), folder / targets, _text(reach, "robot"), _whole(reach, "turns", 1))


def _bases(table: dict[str, Any], folder: Path) -> Bases:
    kind = table.get("kind")
    _chosen("kind", kind, ("grid", "table"))
    if kind == "table":
        return BaseTable(folder / _file(table))
    axes = ("x_m", "y_m", "z_m", "yaw_rad")
    _known(table, ("kind", *axes), "these bases")
    return BaseGrid(**{key: tuple(table[key]) if isinstance(table[key], list) else table[key] for key in axes if key in table})


def _file(table: dict[str, Any]) -> str:
    _known(table, ("kind", "file"), "a table")
    file = _text(table, "file")
    if file is None:
        raise ArgumentError('`file` is missing\n  write: file = "states.npy", which numpy.save has written')
    return file


def _states(table: dict[str, Any], folder: Path) -> States:
    def sequence(kind: Callable[..., States]) -> States:
        _known(table, ("kind", "rows", "seed"), "these states")
        return kind(_whole(table, "rows"), _whole(table, "seed", 1))

    kind = table.get("kind")
    _chosen("kind", kind, ("random", "sobol", "grid", "table"))
    if kind == "random":
        return sequence(Random)
    if kind == "sobol":
        return sequence(Sobol)
    if kind == "table":
        return Table(folder / _file(table))
    _known(table, ("kind", "steps"), "a grid")
    steps = table.get("steps")
    if not isinstance(steps, list) or not all(type(n) is int and 0 < n < 2**31 for n in steps):
        raise ArgumentError(f"`steps` is {steps!r}\n  write: one whole number for each joint, as steps = [20, 20, 10]")
    return Grid(tuple(steps))
