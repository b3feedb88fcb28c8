"""One shard: its states, and the answers about them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from elbowroom import _elbowroom
from elbowroom.errors import Error
from elbowroom.sweep import parts
from elbowroom.sweep.parts import Answers, Part
from elbowroom.sweep.task import Task, fingerprint

# The models of this process, by the digest of their task: a worker computes many shards of one.
_CHECKERS: dict[tuple[str, int | None], _elbowroom.Checker] = {}


@dataclass(frozen=True)
class Job:
    """What all shards of a sweep share.

    Attributes
    ----------
    task, digest
        The task, and the digest of its identity.
    fingerprint
        That of the model at the driver: a worker whose files differ must not answer.
    folder, total
        The folder of the parts, and the number of states.
    """

    task: Task
    digest: str
    fingerprint: str
    folder: Path
    total: int

    def shard_of(self, shard: int) -> tuple[int, int]:
        """Return the number of the first state of a shard, and of its states."""
        first = shard * self.task.shard_rows
        return first, min(self.task.shard_rows, self.total - first)


def remember(job: Job, checker: _elbowroom.Checker) -> None:
    """Keep a model that this process has loaded already, on all cores."""
    _CHECKERS.clear()
    _CHECKERS[job.digest, None] = checker


def compute(job: Job, shard: int, threads: int | None = None) -> Part:
    """Answer a shard, write its part, and return its footer."""
    key = (job.digest, threads)
    if key not in _CHECKERS:
        # One at a time: a worker of a cluster may see many tasks.
        _CHECKERS.clear()
        checker = job.task.checker(threads)
        if fingerprint(checker) != job.fingerprint:
            text = f"{job.task.model}: another model than that of the driver\n  write: the same files on all machines"
            raise Error(text)
        _CHECKERS[key] = checker
    checker = _CHECKERS[key]
    first, count = job.shard_of(shard)
    q = job.task.states.rows(first, count, checker.limits)
    return parts.write(parts.path(job.folder, shard), job.digest, first, _answers(job.task, checker, q))


def _answers(task: Task, checker: _elbowroom.Checker, q: npt.NDArray[np.float64]) -> Answers:
    if task.ask == "collision":
        return Answers(checker.collides(q))
    found = checker.witness(q)
    return Answers(found.distance_m == 0.0, _rounded_down(found.distance_m), found.a, found.b)


def _rounded_down(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Return single precision: never farther apart than they are."""
    single = values.astype(np.float32)
    return np.where(single > values, np.nextafter(single, np.float32(-np.inf)), single).astype(np.float32)
