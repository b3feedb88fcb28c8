"""The driver: which shards are open, who computes them, and the end."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from elbowroom.errors import ArgumentError, Error
from elbowroom.sweep import executors, parts
from elbowroom.sweep.parts import Part
from elbowroom.sweep.progress import Progress
from elbowroom.sweep.result import Result, finish
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
    folder = (Path(out) if out is not None else task.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    identity = task.identity()
    name = digest(identity)
    total = task.states.count(task.checker().limits)
    shards = -(-total // task.shard_rows)
    with _alone(folder):
        found = _finished(folder, name, shards)
        line = Progress(progress, total, sum(part.rows for part in found.values()))
        still_open = (shard for shard in range(shards) if shard not in found)
        compute = executors.ray if chosen == "ray" else executors.local
        for part in compute(task, name, folder, still_open, total):
            found[part.first // task.shard_rows] = part
            line.add(part.rows)
        line.end()
        return finish(folder, identity, list(found.values()))


def _finished(folder: Path, name: str, shards: int) -> dict[int, Part]:
    """Read the parts of an interrupted run, and remove what it did not finish."""
    for unfinished in folder.glob("part-*.tmp"):
        unfinished.unlink(missing_ok=True)
    found = {}
    for file in folder.glob("part-*.parquet"):
        part = parts.read(file)
        shard = int(file.stem.removeprefix("part-"))
        if part is None or part.task != name or shard >= shards:
            raise Error(f"{file}: is a part of another sweep\n  write: another folder, or remove its parts")
        found[shard] = part
    return found


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other drivers out of the folder until this one ends, in whatever way."""
    with (folder / "driver.lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise Error(f"{folder}: another sweep is writing there\n  write: another folder") from error
        yield
