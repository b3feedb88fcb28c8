"""A sweep on a cluster of simulated machines that are removed at random: the hash must be that of one process.

pip install 'elbowroom[sweep]'; then python python/benchmarks/simulated_cluster.py ROBOT.urdf --machines 64

Each machine is a raylet of its own with one processor, all on this machine. Every few seconds one of them is removed without notice, until
eight are left.
"""

from __future__ import annotations

import argparse
import random
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import ray
from ray.cluster_utils import Cluster

from elbowroom import sweep

STORE = {"num_cpus": 1, "object_store_memory": 80_000_000}
#: Machines that are not removed, the first one among them.
LEFT = 8


def main() -> None:
    """Sweep in this process, then on the cluster."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("robot", type=Path)
    words.add_argument("--machines", type=int, default=64)
    words.add_argument("--rows", type=int, default=200_000)
    words.add_argument("--shard-rows", type=int, default=1_000)
    words.add_argument("--seconds", type=float, default=2.0, help="time from one removal to the next")
    found = words.parse_args()
    task = sweep.Task(
        found.robot.resolve(), sweep.Sobol(found.rows), "sweep", is_cell=False, ask="distance", shard_rows=found.shard_rows
    )
    with tempfile.TemporaryDirectory() as folder:
        expected = sweep.run(task, out=Path(folder) / "alone")
        begin = time.monotonic()
        cluster: Any = Cluster(initialize_head=True, head_node_args=STORE)
        machines = [cluster.add_node(**STORE) for _ in range(found.machines - 1)]
        ray.init(address=cluster.address, log_to_driver=False)
        print(f"{len(ray.nodes())} machines after {time.monotonic() - begin:.0f} s", flush=True)
        answers: list[sweep.Result] = []
        begin = time.monotonic()
        sweeping = threading.Thread(target=lambda: answers.append(sweep.run(task, out=Path(folder) / "cluster", executor="ray")))
        sweeping.start()
        rng, removed = random.Random(1), 0
        while sweeping.is_alive():
            sweeping.join(found.seconds)
            if sweeping.is_alive() and len(machines) >= LEFT:
                cluster.remove_node(machines.pop(rng.randrange(len(machines))), allow_graceful=False)
                removed += 1
        took, result = time.monotonic() - begin, answers[0]
        ray.shutdown()
        cluster.shutdown()
    same = "the same hash" if result.sha256 == expected.sha256 else "ANOTHER HASH"
    print(f"{result.rows} rows in {took:.0f} s, {removed} machines removed: {same}, {result.sha256[:8]}…; counts equal: {result.counts == expected.counts}")


if __name__ == "__main__":
    main()
