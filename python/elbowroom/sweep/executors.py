"""Where shards are computed: in this process, or on a Ray cluster."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from elbowroom.errors import Error
from elbowroom.sweep.extras import imported
from elbowroom.sweep.parts import Part
from elbowroom.sweep.shard import Job, compute

# Shards that wait at a cluster, for each of its processors: enough to keep it busy, few enough for the driver's memory.
_WAITING = 4


def local(job: Job, shards: Iterable[int]) -> Iterator[Part]:
    """Compute shards one after another, each on all cores."""
    for shard in shards:
        yield compute(job, shard)


def ray(job: Job, shards: Iterable[int]) -> Iterator[Part]:
    """Compute shards as tasks of a processor each. A worker or a node that dies costs its shards, which are computed again."""
    cluster = imported("ray", "Ray")
    if not cluster.is_initialized():
        # `RAY_ADDRESS` names a cluster; without it one starts on this machine.
        cluster.init(include_dashboard=False, log_to_driver=False, configure_logging=False)
    work = cluster.remote(num_cpus=1, max_retries=-1)(compute)
    shared = cluster.put(job)
    open_shards = iter(shards)
    waiting: list[Any] = []
    most = _WAITING * max(1, int(cluster.cluster_resources().get("CPU", 1)))
    while True:
        waiting += [work.remote(shared, shard, 1) for shard in islice(open_shards, most - len(waiting))]
        if not waiting:
            return
        done, waiting = cluster.wait(waiting, num_returns=1)
        try:
            yield cluster.get(done[0])
        except cluster.exceptions.RayTaskError as failed:
            raise failed.cause if isinstance(failed.cause, Error) else failed from failed
