"""One shard: its states, and the answers about them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from elbowroom.errors import Error
from elbowroom.sweep import parts
from elbowroom.sweep.parts import Part
from elbowroom.sweep.questions import Question
from elbowroom.sweep.task import Task

# The model of this process, by the digest of its task: a worker computes many shards of one.
_QUESTIONS: dict[tuple[str, int | None], Question] = {}


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


def remember(job: Job, question: Question) -> None:
    """Keep a model that this process has loaded already, on all cores."""
    _QUESTIONS.clear()
    _QUESTIONS[job.digest, None] = question


def compute(job: Job, shard: int, threads: int | None = None) -> Part:
    """Answer a shard, write its part, and return its footer."""
    key = (job.digest, threads)
    if key not in _QUESTIONS:
        # One at a time: a worker of a cluster may see many tasks.
        _QUESTIONS.clear()
        question = job.task.question(threads)
        if job.task.fingerprint(question) != job.fingerprint:
            text = f"{job.task.model}: another model than that of the driver\n  write: the same files on all machines"
            raise Error(text)
        _QUESTIONS[key] = question
    first, count = job.shard_of(shard)
    columns = _QUESTIONS[key].answer(first, count)
    return parts.write(parts.path(job.folder, shard), job.digest, first, count, columns)
