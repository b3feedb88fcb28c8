"""Collision points beside Coal's contacts, for `cargo xtask contacts`.

usage: coal_contacts.py FOLDER

FOLDER/job.txt and job.bin are those of pin_coal.py, which stands beside this file. FOLDER/ours.txt has a line per state: `-`
where nothing collides, else the geometries I J, their triangles (-1: none), 1 where surfaces touch, the point on each,
and the outward normal of each (12 numbers).
Printed, `key value` a line: what agrees and what does not; then up to five lines `! WHY`.
"""

import os
import sys

import coal
import numpy as np
import pinocchio as pin

from pin_coal import Job, build, configurations

# A point is on a surface, metres; a direction is another, sine.
ON, ALONG = 1e-9, 1e-6


class Meshes:
    """Corners and triangles of the geometries that are meshes, in their own frames."""

    def __init__(self, job, states):
        at = job.count * len(job.joints) * 8
        self.of = {}
        for i, (_, kind, numbers) in enumerate(job.geometries):
            if kind != "mesh":
                continue
            corners, triangles = (int(n) for n in numbers[:2])
            v = np.frombuffer(job.binary, "<f8", 3 * corners, at).reshape(-1, 3)
            at += v.nbytes
            t = np.frombuffer(job.binary, "<u4", 3 * triangles, at).reshape(-1, 3)
            at += t.nbytes
            self.of[i] = (v, t)

    def corners(self, i, triangle, placement):
        v, t = self.of[i]
        return v[t[triangle]] @ placement.rotation.T + placement.translation


def normal_of(corners):
    n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return n / np.linalg.norm(n)


def off_triangle(p, corners):
    """How far a point is outside of a triangle, metres."""
    n = normal_of(corners)
    off = abs(n @ (p - corners[0]))
    for k in range(3):
        edge = corners[(k + 1) % 3] - corners[k]
        inward = np.cross(n, edge) / np.linalg.norm(edge)
        off = max(off, -(inward @ (p - corners[k])))
    return off


def off_box(p, half, placement):
    """How far a point is from the surface of a box, metres."""
    q = np.abs(placement.rotation.T @ (p - placement.translation))
    out = np.linalg.norm(np.maximum(q - half, 0.0))
    return max(out, abs(np.max(q - half))) if out == 0.0 else out


class Comparison:
    def __init__(self, job, states, solids, model):
        self.job, self.solids = job, solids
        self.meshes = Meshes(job, states)
        objects = solids.geometryObjects
        # Moving joints above; what stands in the world is no link.
        self.depth = [len(model.supports[g.parentJoint]) - 1 if job.geometries[i][0] else np.inf for i, g in enumerate(objects)]
        self.tally = dict.fromkeys(
            "states free contacts contained comparison link pair triangle point normal face edge sign several".split(), 0
        )
        self.why = []

    def wrong(self, what, why):
        self.tally[what] += 1
        if len(self.why) < 5:
            self.why.append(f"{what}: {why}")

    def state(self, number, line, colliding, placements):
        tally = self.tally
        tally["states"] += 1
        ours = None if line == "-" else line.split()
        if ours is None or not colliding:
            if ours is None and not colliding:
                tally["free"] += 1
            elif ours is not None and ours[4] == "1" and self.inside(ours, placements):
                tally["contained"] += 1
            else:
                self.wrong("comparison", f"state {number}: ours {line}, theirs {colliding}")
            return
        i, j, ti, tj, touching = (int(n) for n in ours[:5])
        p, q, n, m = np.array([float(x) for x in ours[5:]]).reshape(4, 3)
        pairs = [(a, b) if (a, b) != (j, i) else (i, j) for a, b in colliding]
        depth = lambda pair: min(self.depth[pair[0]], self.depth[pair[1]])
        highest = min(depth(pair) for pair in pairs)
        tally["several"] += len({depth(pair) for pair in pairs}) > 1
        if (i, j) not in pairs:
            if self.inside(ours, placements):
                tally["contained"] += 1
            else:
                self.wrong("pair", f"state {number}: {i} {j} not among {pairs}")
            return
        if depth((i, j)) != highest:
            self.wrong("link", f"state {number}: {i} {j} at {depth((i, j))}, highest of {pairs} is {highest}")
        tally["contacts"] += 1
        found = self.contacts(i, j, placements)
        if not any((ti < 0 or a == ti) and (tj < 0 or b == tj) for a, b, _ in found):
            self.wrong("triangle", f"state {number}: {i}:{ti} {j}:{tj} not among {len(found)} contacts")
        off = max(self.off(i, ti, p, placements), self.off(j, tj, q, placements), np.linalg.norm(p - q))
        if off > ON:
            self.wrong("point", f"state {number}: {i}:{ti} {j}:{tj} off by {off}")
        for k, triangle, normal in ((i, ti, n), (j, tj, m)):
            if triangle >= 0:
                plane = normal_of(self.meshes.corners(k, triangle, placements[k]))
                if np.linalg.norm(np.cross(plane, normal)) > ALONG:
                    self.wrong("normal", f"state {number}: {k}:{triangle} {plane} {normal}")
        theirs = [c for a, b, c in found if (ti < 0 or a == ti) and (tj < 0 or b == tj)]
        for c in theirs[:1]:
            # From the first to the second: out of the first, into the second.
            of_first, of_second = np.linalg.norm(np.cross(c, n)) < 1e-3, np.linalg.norm(np.cross(c, m)) < 1e-3
            if of_first or of_second:
                tally["face"] += 1
                if not ((of_first and c @ n > 0) or (of_second and c @ m < 0)):
                    self.wrong("sign", f"state {number}: {i}:{ti} {j}:{tj} theirs {c} ours {n} {m}")
            else:
                tally["edge"] += 1

    def inside(self, ours, placements):
        """True where the reported geometries do not touch by their surfaces."""
        return not self.contacts(int(ours[0]), int(ours[1]), placements)

    def contacts(self, i, j, placements):
        """Their contacts: triangle of each, and the normal from i to j."""
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        request.num_max_contacts = 100000
        request.enable_contact = True
        request.gjk_tolerance, request.gjk_max_iterations = 1e-10, 1000
        g = self.solids.geometryObjects
        at = [coal.Transform3s(placements[k].rotation, placements[k].translation) for k in (i, j)]
        coal.collide(g[i].geometry, at[0], g[j].geometry, at[1], request, result)
        return [(c.b1, c.b2, np.array(c.normal)) for c in result.getContacts()]

    def off(self, k, triangle, p, placements):
        if triangle >= 0:
            return off_triangle(p, self.meshes.corners(k, triangle, placements[k]))
        _, kind, numbers = self.job.geometries[k]
        return off_box(p, np.array(numbers[:3]) / 2, placements[k]) if kind == "box" else 0.0


def main():
    folder = sys.argv[1]
    job = Job(folder)
    states = job.take(job.count * len(job.joints), "<f8").reshape(job.count, -1)
    model, solids, _ = build(job)
    data, solid_data = model.createData(), solids.createData()
    for request in solid_data.collisionRequests:
        request.gjk_tolerance = 1e-10
        request.gjk_max_iterations = 1000
    comparison = Comparison(job, states, solids, model)
    lines = open(os.path.join(folder, "ours.txt")).read().splitlines()
    for number, (line, q) in enumerate(zip(lines, configurations(job, model, states))):
        pin.computeCollisions(model, data, solids, solid_data, q, False)
        hits = [k for k, result in enumerate(solid_data.collisionResults) if result.isCollision()]
        colliding = [job.pairs[k][:2] for k in hits]
        comparison.state(number, line, colliding, list(solid_data.oMg))
    for key, value in comparison.tally.items():
        print(key, value)
    for why in comparison.why:
        print("!", why)


if __name__ == "__main__":
    main()
