"""Collisions and distances of robots with themselves, beside pinocchio with Coal and python-fcl, on one core and in one run.

pip install pin python-fcl; then python python/benchmarks/beside_peers.py ROBOT.urdf ROBOT.srdf [...]

Every library has the same meshes, the pairs that the SRDF leaves, and the same random states within the limits. Python calls pinocchio once
per state, python-fcl once per pair, and elbowroom once for all states. Where a library needs more than a minute it gets fewer states.
With --rust PROGRAM, which `cargo bench -p elbowroom-query --bench row_times --no-run` names, the library is timed on the same states.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import elbowroom as er

States = npt.NDArray[np.float64]
Answer = Callable[[States], npt.NDArray[Any]]

#: Longest measurement of a peer, seconds.
LONGEST_S = 60.0


def configurations(model: Any, joints: list[str]) -> Callable[[States], States]:
    """Return how a row of values becomes a configuration of a model of pinocchio."""
    import pinocchio as pin

    neutral = pin.neutral(model)
    places = [model.joints[model.getJointId(name)].idx_q for name in joints]

    def full(row: States) -> States:
        q: States = neutral.copy()
        q[places] = row
        return q

    return full


def pinocchio_answers(urdf: Path, srdf: Path, joints: list[str]) -> tuple[Answer, Answer, Any, Any]:
    """Return pinocchio's collisions and distances of rows, its model and its pairs."""
    import pinocchio as pin

    # Joints that mimic another one have no value of their own, as here.
    model = pin.buildModelFromUrdf(str(urdf), mimic=True)
    geometry = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION, package_dirs=[str(urdf.parent), str(urdf.parent.parent)])
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, str(srdf))
    data, geometry_data, full = model.createData(), pin.GeometryData(geometry), configurations(model, joints)

    def collides(q: States) -> npt.NDArray[Any]:
        return np.array([pin.computeCollisions(model, data, geometry, geometry_data, full(row), True) for row in q])

    def distance(q: States) -> npt.NDArray[Any]:
        out = []
        for row in q:
            pin.computeDistances(model, data, geometry, geometry_data, full(row))
            out.append(min(result.min_distance for result in geometry_data.distanceResults))
        return np.maximum(np.array(out), 0.0)

    return collides, distance, model, geometry


def fcl_answers(model: Any, geometry: Any, joints: list[str]) -> tuple[Answer, Answer]:
    """Return the collisions and distances of rows by python-fcl, with the meshes, pairs and places of pinocchio's model."""
    import fcl
    import pinocchio as pin

    data, geometry_data, full = model.createData(), pin.GeometryData(geometry), configurations(model, joints)
    objects = []
    for solid in geometry.geometryObjects:
        mesh = solid.geometry
        vertices = np.array([mesh.vertices(i) for i in range(mesh.num_vertices)]) * solid.meshScale
        corners = [mesh.tri_indices(i) for i in range(mesh.num_tris)]
        faces = np.array([[corner[0], corner[1], corner[2]] for corner in corners])
        bvh = fcl.BVHModel()
        bvh.beginModel(len(vertices), len(faces))
        bvh.addSubModel(vertices, faces)
        bvh.endModel()
        objects.append(fcl.CollisionObject(bvh))
    pairs = [(pair.first, pair.second) for pair in geometry.collisionPairs]

    def place(row: States) -> None:
        pin.updateGeometryPlacements(model, data, geometry, geometry_data, full(row))
        for solid, pose in zip(objects, geometry_data.oMg, strict=True):
            solid.setTransform(fcl.Transform(pose.rotation, pose.translation))

    def collides(q: States) -> npt.NDArray[Any]:
        out = []
        for row in q:
            place(row)
            out.append(any(fcl.collide(objects[a], objects[b], fcl.CollisionRequest(), fcl.CollisionResult()) for a, b in pairs))
        return np.array(out)

    def distance(q: States) -> npt.NDArray[Any]:
        out = []
        for row in q:
            place(row)
            out.append(min(fcl.distance(objects[a], objects[b], fcl.DistanceRequest(), fcl.DistanceResult()) for a, b in pairs))
        return np.maximum(np.array(out), 0.0)

    return collides, distance


def timed(answer: Answer, q: States) -> tuple[npt.NDArray[Any], float]:
    """Return the answers and the microseconds per row; for fewer rows if all would take more than a minute."""
    begin = time.perf_counter()
    answer(q[:20])
    per_row = (time.perf_counter() - begin) / 20
    rows = q[: max(20, min(len(q), int(LONGEST_S / per_row)))]
    begin = time.perf_counter()
    found = answer(rows)
    return found, 1e6 * (time.perf_counter() - begin) / len(rows)


def beside_rust(program: Path, urdf: Path, srdf: Path, q: States, checker: er.Checker) -> None:
    """Print the time of a state in Python and in Rust, the least of five turns each."""
    questions: dict[str, tuple[Answer, list[float], list[float]]]
    questions = {"collision": (checker.collides, [], []), "distance": (checker.distance, [], [])}
    with tempfile.NamedTemporaryFile() as states:
        q.astype("<f8").tofile(states.name)
        for _ in range(5):
            told = subprocess.run([program, urdf, srdf, states.name], check=True, capture_output=True, text=True).stdout
            for line in told.splitlines():
                name, microseconds = line.split()
                answer, ours, theirs = questions[name]
                theirs.append(float(microseconds))
                begin = time.perf_counter()
                answer(q)
                ours.append(1e6 * (time.perf_counter() - begin) / len(q))
    for name, (_, ours, theirs) in questions.items():
        python, rust = min(ours), min(theirs)
        print(f"  {name:10} of a state: Python {python:.3f} us, Rust {rust:.3f} us, {100 * (python / rust - 1):+.1f} %")


def measure(urdf: Path, srdf: Path, rows: int, rust: Path | None) -> None:
    """Print a line per library and question."""
    robot = er.Robot.load(urdf, srdf)
    q = np.random.default_rng(1).uniform(*robot.limits.T, (rows, robot.dof))
    if rust is not None:
        return beside_rust(rust, urdf, srdf, q, er.Checker(robot, threads=1))
    one, two = er.Checker(robot, threads=1), er.Checker(robot, threads=2)
    collides, distance, model, geometry = pinocchio_answers(urdf, srdf, robot.joints)
    fcl_collides, fcl_distance = fcl_answers(model, geometry, robot.joints)
    print(f"{urdf.stem}: {len(geometry.collisionPairs)} pairs in pinocchio")
    questions: list[tuple[str, Answer, Answer, Answer, Answer]] = [
        ("collision", one.collides, two.collides, collides, fcl_collides),
        ("distance", one.distance, two.distance, distance, fcl_distance),
    ]
    for question, ours, both, of_pinocchio, of_fcl in questions:
        expected, mine = timed(ours, q)
        _, together = timed(both, q)
        print(f"  {question:10} elbowroom   {mine:9.2f} us   {len(expected):7} rows, two threads {mine / together:.2f} x")
        for name, answer in (("pinocchio", of_pinocchio), ("python-fcl", of_fcl)):
            found, took = timed(answer, q)
            same = expected[: len(found)]
            differ = int((found != same).sum()) if question == "collision" else float(np.abs(found - same).max())
            print(f"  {question:10} {name:11} {took:9.2f} us   {len(found):7} rows, {took / mine:8.1f} x as long, differ by {differ:.2g}")
    # The same random states, once a call for each, once a call for all.
    some = q[:20_000]
    rows_alone = [row[None] for row in some]
    for name, call in (("collides", one.collides), ("distance", one.distance)):
        begin = time.perf_counter()
        for row in rows_alone:
            call(row)
        alone = 1e6 * (time.perf_counter() - begin) / len(some)
        begin = time.perf_counter()
        call(some)
        print(f"  {name} of one row {alone:.2f} us, of a row among many {1e6 * (time.perf_counter() - begin) / len(some):.2f} us")


def main() -> None:
    """Read the command line."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("files", nargs="+", type=Path, help="ROBOT.urdf ROBOT.srdf …")
    words.add_argument("--rows", type=int, default=100_000)
    words.add_argument("--rust", type=Path, help="the bench row_times: compare with it alone")
    found = words.parse_args()
    if len(found.files) % 2:
        sys.exit("a URDF and an SRDF for each robot")
    print(f"elbowroom {er.__version__}, {os.cpu_count()} processors")
    for urdf, srdf in zip(found.files[::2], found.files[1::2], strict=True):
        measure(urdf, srdf, found.rows, found.rust)


if __name__ == "__main__":
    main()
