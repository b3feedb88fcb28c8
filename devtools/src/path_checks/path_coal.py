"""Collisions along paths by Pinocchio and Coal, for `cargo xtask paths`.

usage: path_coal.py FOLDER POINTS

FOLDER/job.txt and job.bin are those of pin_coal.py, without states. FOLDER/paths.bin holds of each path the number of its
rows, then the rows: a time and the joint values (all f64). Each path is checked at POINTS points evenly spread over
its times, linear between rows.
Printed, apart by tabs: points checked, paths with a collision, the first of these in words.
"""

import os
import sys

import numpy as np
import pinocchio as pin

from pin_coal import Job, build, configurations


def paths(folder, joints):
    values = np.fromfile(os.path.join(folder, "paths.bin"), dtype="<f8")
    at = 0
    while at < len(values):
        rows = int(values[at])
        at += 1
        yield values[at : at + rows * (joints + 1)].reshape(rows, joints + 1)
        at += rows * (joints + 1)


def main():
    folder, points = sys.argv[1], int(sys.argv[2])
    job = Job(folder)
    model, solids, _ = build(job)
    threads = os.cpu_count() or 1
    pool = pin.GeometryPool(model, solids, threads)
    looked, hits, first = 0, 0, ""
    for number, path in enumerate(paths(folder, len(job.joints))):
        times = np.linspace(path[0, 0], path[-1, 0], points)
        states = np.column_stack([np.interp(times, path[:, 0], path[:, 1 + j]) for j in range(len(job.joints))])
        q = configurations(job, model, states).T
        collides = np.array(pin.computeCollisionsInParallel(threads, pool, np.asfortranarray(q), True, False))
        looked += points
        if collides.any():
            hits += 1
            at = int(np.argmax(collides))
            first = first or f"path {number}: collision at {states[at].tolist()}, {int(collides.sum())} of {points} points"
    print(looked, hits, first, sep="\t")


main()
