"""The driver: which shards are open, who computes them, and the end."""

from __future__ import annotations

import fcntl
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from elbowroom.errors import ArgumentError, Error
from elbowroom.sweep import executors, parts
from elbowroom.sweep.parts import Part
from elbowroom.progress import Progress
from elbowroom.sweep.result import MANIFEST, Result, finish
from elbowroom.sweep.shard import Job, remember
from elbowroom.sweep.task import Task, digest


def run(
    task: Task, *, out: str | Path | None = None, executor: str | None = None, progress: bool = False
) -> Result:
    """Compute all shards that are not there yet, and write the manifest.

    Parameters
    ----------
    task
        What is asked.
    out
        The folder for the parts, instead of the task's. On a cluster all machines must see it, and the files of the model, at the
        same paths.
    executor
        `"local"` or `"ray"`, instead of the task's.
    progress
        Whether a line on standard error shows rate and remaining time.

    Returns
    -------
    Result

    Raises
    ------
    Error
        If the folder has parts of another task, or another sweep is writing to it.
    """
    chosen = executor or task.executor
    if chosen not in ("local", "ray"):
        raise ArgumentError(f"`executor` is {chosen!r}\n  write: local or ray")
    folder = Path(task.out if out is None else out).resolve()
    question = task.question()
    identity = task.identity(question)
    total = question.count()
    job = Job(task, digest(identity), identity["fingerprint"], folder, total)
    remember(job, question)
    with _alone(folder):
        # What it says is true of finished sweeps only.
        (folder / MANIFEST).unlink(missing_ok=True)
        found = _finished(job)
        line = Progress(progress, total, sum(part.rows for part in found.values()))
        still_open = (shard for shard in range(-(-total // task.shard_rows)) if shard not in found)
        compute = executors.ray if chosen == "ray" else executors.local
        for part in compute(job, still_open):
            found[part.first // task.shard_rows] = part
            line.add(part.rows)
        line.end()
        return finish(folder, identity, question, list(found.values()))


def _finished(job: Job) -> dict[int, Part]:
    """Read the footers of an interrupted run, and remove what it did not finish."""
    for unfinished in job.folder.glob("part-*.tmp"):
        unfinished.unlink(missing_ok=True)
    found = {}
    for file in job.folder.glob("part-*.parquet"):
        part = parts.read(file)
        shard = part.first // job.task.shard_rows
        belongs = part.task == job.digest and file == parts.path(job.folder, shard)
        if not belongs or (part.first, part.rows) != job.shard_of(shard):
            raise Error(f"{file}: is not a part of this sweep\n  write: another folder, or remove the file")
        found[shard] = part
    return found


@contextmanager
def _alone(folder: Path) -> Generator[None, None, None]:
    """Make the folder, and keep other drivers out of it until this one ends, in whatever way."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = (folder / "driver.lock").open("w")
    except OSError as error:
        raise Error(f"{folder}: cannot be written to: {error}\n  write: another folder") from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Error(f"{folder}: another sweep is writing there\n  write: another folder") from error
        yield
