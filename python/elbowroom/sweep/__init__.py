"""Queries about very many states or places of a base, shard by shard, on one machine or on a Ray cluster.

A sweep is a task: a model, a set of states in a fixed order, and what is asked about them; or targets of a robot and places of
its base. The rows are cut into shards. Each
shard is computed on its own and becomes one Parquet file, written under another name first. So a sweep that was killed goes on
where it stopped, a worker that dies costs only its shard, and nothing is lost or counted twice.

>>> from elbowroom import sweep
>>> task = sweep.Task.load("sweep.toml")     # doctest: +SKIP
>>> sweep.run(task).counts                   # doctest: +SKIP

The command `elbowroom sweep sweep.toml` and `python -m elbowroom.sweep sweep.toml` do the same. Needs pyarrow; `sobol` states
need SciPy, and `executor = "ray"` needs Ray: `pip install 'elbowroom[sweep]'` has all of them.
"""

from elbowroom.sweep.bases import BaseGrid, BaseTable
from elbowroom.sweep.driver import run
from elbowroom.sweep.placement import Placement
from elbowroom.sweep.result import Result
from elbowroom.sweep.states import Grid, Random, Sobol, Table
from elbowroom.sweep.task import Placements, Task

__all__ = ["BaseGrid", "BaseTable", "Grid", "Placement", "Placements", "Random", "Result", "Sobol", "Table", "Task", "run"]
