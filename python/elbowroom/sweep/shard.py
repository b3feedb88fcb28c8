"""One shard: its states, and the answers about them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from elbowroom import _elbowroom
from elbowroom.sweep import parts
from elbowroom.sweep.parts import Answers, Part
from elbowroom.sweep.task import Task

# The models of this process, by the digest of their task: a worker computes many shards of one.
_CHECKERS: dict[tuple[str, int | None], _elbowroom.Checker] = {}


def compute(task: Task, digest: str, out: Path, shard: int, total: int, threads: int | None = None) -> Part:
    """Answer a shard, write its part, and return its footer."""
    key = (digest, threads)
    if key not in _CHECKERS:
        # One at a time: a worker of a cluster may see many tasks.
        _CHECKERS.clear()
        _CHECKERS[key] = task.checker(threads)
    checker = _CHECKERS[key]
    first = shard * task.shard_rows
    q = task.states.rows(first, min(task.shard_rows, total - first), checker.limits)
    return parts.write(parts.path(out, shard), digest, first, _answers(task, checker, q))


def _answers(task: Task, checker: _elbowroom.Checker, q: npt.NDArray[np.float64]) -> Answers:
    if task.ask == "collision":
        return Answers(checker.collides(q))
    found = checker.witness(q)
    return Answers(found.distance_m == 0.0, _rounded_down(found.distance_m), found.a, found.b)


def _rounded_down(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Return single precision: never farther apart than they are."""
    single = values.astype(np.float32)
    return np.where(single > values, np.nextafter(single, np.float32(-np.inf)), single).astype(np.float32)
