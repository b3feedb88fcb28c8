"""A damped least squares with Pinocchio on the questions of the bench any_point.

usage: pin_dls.py ROBOT.urdf JOINTS LINK < questions

Each line holds point and normal on the link, the wanted point and normal (zeros where the normal is free), and the start
(order of JOINTS, comma-separated). Prints one line: how many are reached to 1e-6 m and 1e-6 rad from the given start and with
up to 99 starts more, and the time: of the whole loop, which is Python and NumPy, and of Pinocchio's own calls in it
(bindings and the clock included).

The method is that of Pinocchio's inverse kinematics example with steps of full length: dq = J^T (J J^T + damping)^-1 e,
on the same three or five rows, q clamped to the limits after each step, steps shortened to one radian.
"""

import os
import sys
from time import perf_counter_ns

# Threads for a system of five equations only cost time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402

DAMPING, ITERATIONS, STARTS = 1e-6, 100, 100
AROUND = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def tangents(n):
    a = np.array([1.0, 0, 0]) if abs(n[0]) < 0.6 else np.array([0, 1.0, 0])
    t1 = np.cross(n, a)
    t1 /= np.linalg.norm(t1)
    return t1, np.cross(n, t1)


class Search:
    def __init__(self, path, link):
        self.model = pin.buildModelFromUrdf(path)
        self.data = self.model.createData()
        self.frame = self.model.getFrameId(link, pin.FrameType.BODY)
        self.lower, self.upper = self.model.lowerPositionLimit, self.model.upperPositionLimit
        self.in_calls_ns = self.iterations = 0

    def rows(self, q, point, normal, wanted, wanted_normal):
        begin = perf_counter_ns()
        jacobian = pin.computeFrameJacobian(self.model, self.data, q, self.frame, AROUND)
        pose = pin.updateFramePlacement(self.model, self.data, self.frame)
        self.in_calls_ns += perf_counter_ns() - begin
        lever = pose.rotation @ point
        e = wanted - pose.translation - lever
        j = jacobian[:3] - pin.skew(lever) @ jacobian[3:]
        if wanted_normal is None:
            return e, j, np.linalg.norm(e), 0.0
        n = pose.rotation @ normal
        t1, t2 = tangents(n)
        a, b, cosine = t1 @ wanted_normal, t2 @ wanted_normal, n @ wanted_normal
        sine = np.hypot(a, b)
        angle = np.arctan2(sine, cosine)
        k = angle / sine if sine > 1e-12 else 1.0
        e5 = np.concatenate([e, [a * k, b * k]])
        j5 = np.vstack([j, t2 @ jacobian[3:], -t1 @ jacobian[3:]])
        return e5, j5, np.linalg.norm(e), angle

    def descend(self, q, *question):
        for _ in range(ITERATIONS):
            self.iterations += 1
            e, j, metres, radians = self.rows(q, *question)
            if metres <= 1e-6 and radians <= 1e-6:
                return True
            dq = j.T @ np.linalg.solve(j @ j.T + DAMPING * np.eye(len(e)), e)
            largest = np.abs(dq).max(initial=0.0)
            q = np.clip(q + dq / max(1.0, largest), self.lower, self.upper)
        return False


def main():
    path, names, link = sys.argv[1], sys.argv[2].split(","), sys.argv[3]
    search = Search(path, link)
    order = [search.model.joints[search.model.getJointId(name)].idx_q for name in names]
    random = np.random.default_rng(1)
    asked = first = reached = 0
    times = []
    for line in sys.stdin:
        v = np.array([float(word) for word in line.split()])
        q = np.zeros(search.model.nq)
        q[order] = v[12:]
        wanted_normal = v[9:12] if np.any(v[9:12]) else None
        begin = perf_counter_ns()
        for start in range(STARTS):
            if search.descend(q, v[0:3], v[3:6], v[6:9], wanted_normal):
                reached += 1
                first += start == 0
                break
            q = random.uniform(search.lower, search.upper)
        times.append((perf_counter_ns() - begin) / 1e3)
        asked += 1
    calls_us = search.in_calls_ns / 1e3 / search.iterations
    print(
        f"  pinocchio {pin.__version__}: n {asked}, reached {100 * reached / asked:.3f} % "
        f"({100 * first / asked:.2f} % from the first start), median {np.median(times):.0f} us, "
        f"p99 {np.percentile(times, 99):.0f} us, mean {np.mean(times):.0f} us in Python; {search.iterations / asked:.1f} iterations each, "
        f"{calls_us:.2f} us of Pinocchio in each, mean {calls_us * search.iterations / asked:.0f} us"
    )


main()
