"""The task of a sweep: what is asked about which states of which model."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom import _elbowroom
from elbowroom.errors import ArgumentError, FileError
from elbowroom.sweep.states import Grid, Random, Sobol, States, Table

_KEYS = ("version", "cell", "robot", "srdf", "ask", "level", "between", "shard_rows", "executor", "out", "states")
_ASK = ("collision", "distance")
_EXECUTORS = ("local", "ray")
_LARGEST_SHARD = 10_000_000
# States whose answers are compared to tell whether two models are one.
_PROBES = 256


@dataclass(frozen=True)
class Task:
    """What is asked about which states of which model.

    Parameters
    ----------
    model
        A cell file, or the file of a robot.
    states
        The states: `Random`, `Sobol`, `Grid` or `Table` of `elbowroom.sweep.states`.
    out
        Folder of the parts and the manifest.
    is_cell
        Whether `model` is a cell file.
    srdf
        Pairs of a robot that are not compared.
    ask
        `"collision"`, or `"distance"`, which also names the nearest pair.
    level, between
        As for `elbowroom.Checker`.
    shard_rows
        Number of states per part.
    executor
        `"local"`, or `"ray"`.
    """

    model: Path
    states: States
    out: Path
    is_cell: bool = True
    srdf: Path | None = None
    ask: str = "distance"
    level: str = "auto"
    between: str | None = None
    shard_rows: int = 100_000
    executor: str = "local"

    def __post_init__(self) -> None:
        """Refuse values that are not possible."""
        _chosen("ask", self.ask, _ASK)
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

    def checker(self, threads: int | None = None) -> _elbowroom.Checker:
        """Load the model and make its checker."""
        source: _elbowroom.Cell | _elbowroom.Robot
        source = _elbowroom.Cell.load(self.model) if self.is_cell else _elbowroom.Robot.load(self.model, self.srdf)
        return _elbowroom.Checker(source, level=self.level, between=self.between, threads=threads)

    def identity(self, checker: _elbowroom.Checker) -> dict[str, Any]:
        """Return what the answers depend on. Parts of one sweep have the same; where the work is done does not count."""
        states = {key: str(value) if isinstance(value, Path) else value for key, value in vars(self.states).items()}
        return {
            "elbowroom": _elbowroom.__version__,
            "model": self.model.name,
            "fingerprint": fingerprint(checker),
            "files": [checksum(file) for file in self.states.files()],
            "states": {"kind": type(self.states).__name__.lower(), **states},
            "ask": self.ask,
            "level": self.level,
            "between": self.between,
            "shard_rows": self.shard_rows,
        }


def fingerprint(checker: _elbowroom.Checker) -> str:
    """Return a hash, in hex, of what a model answers about some states of its own.

    A model is many files, on each machine. Two that answer alike to the bit, with nearest points, are taken for one.
    """
    q = Random(_PROBES, 1).rows(0, _PROBES, checker.limits)
    found = checker.witness(q)
    content = hashlib.sha256(json.dumps([checker.joints, found.a, found.b]).encode())
    for values in (checker.limits, found.distance_m, found.point_a_m, found.point_b_m):
        content.update(np.ascontiguousarray(values).tobytes())
    return content.hexdigest()


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
    states = table.get("states")
    if not isinstance(states, dict):
        raise ArgumentError('the states are missing\n  write: [states] with kind = "random" and rows = 1000000')
    text = {key: _text(table, key) for key in ("cell", "robot", "srdf", "ask", "level", "between", "executor", "out")}
    srdf = text["srdf"]
    if srdf and "cell" in table:
        raise ArgumentError("`srdf` belongs to a robot\n  write: srdf = \"arm.srdf\" in the cell file, below [robot.NAME]")
    return Task(
        model=folder / str(text["cell"] or text["robot"]),
        states=_states(states, folder),
        out=folder / (text["out"] or f"{name}-sweep"),
        is_cell="cell" in table,
        srdf=folder / srdf if srdf else None,
        ask=text["ask"] or "distance",
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


def _whole(table: dict[str, Any], key: str, default: int | None = None) -> int:
    value = table.get(key, default)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise ArgumentError(f"`{key}` is {value!r}\n  write: a whole number, as {key} = 1000")
    return value


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
        _known(table, ("kind", "file"), "a table")
        file = _text(table, "file")
        if file is None:
            raise ArgumentError('`file` is missing\n  write: file = "states.npy", which numpy.save has written')
        return Table(folder / file)
    _known(table, ("kind", "steps"), "a grid")
    steps = table.get("steps")
    if not isinstance(steps, list) or not all(type(n) is int and 0 < n < 2**31 for n in steps):
        raise ArgumentError(f"`steps` is {steps!r}\n  write: one whole number for each joint, as steps = [20, 20, 10]")
    return Grid(tuple(steps))
