"""Distances and collisions of a robot by Pinocchio and Coal, for `cargo xtask cross-validate`.

usage: pin_coal.py FOLDER

FOLDER/job.txt says what there is, a line each, words apart by tabs:
  urdf PATH | joints NAME… | states COUNT | whole COUNT | pair I J QUERIED
  geometry LINK KIND NUMBERS… POSE (12 numbers, rows of 3x4): box x y z | sphere r | cylinder r height | capsule r height-without-caps | mesh NV NT
  LINK is empty for what stands in the world. QUERIED is 0 for a pair whose distance FOLDER/known.bin covers.
FOLDER/job.bin holds the states (f64), then of each mesh its corners (f64) and triangles (u32).
FOLDER/known.bin, where there is one, holds the least distance over the pairs that are not queried (f64 per state).
Written: FOLDER/least.bin (f64 per state: least distance over all pairs, each pair within the least so far),
FOLDER/whole.bin (f64, for the first `whole` states: least of computeDistances, every pair to the end) and
FOLDER/collides.bin (u8 per state). Printed: microseconds per state of computeDistances and of computeCollisions, which
stops at the first contact (with the requests as Pinocchio makes them), over the first `whole` states; then of least.bin
over all. Each moves the robot first.
"""

import os
import sys
import time
import xml.etree.ElementTree as ET

import coal
import numpy as np
import pinocchio as pin


def joint_value(name, mimics, free):
    if name in free:
        return free[name]
    mimic = mimics[name]
    source = joint_value(mimic.get("joint"), mimics, free)
    return float(mimic.get("multiplier", 1)) * source + float(mimic.get("offset", 0))


def mesh(vertices, triangles):
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices))
    rows = coal.StdVec_Triangle()
    for a, b, c in triangles.tolist():
        rows.append(coal.Triangle(a, b, c))
    model.addSubModel(points(vertices), rows)
    model.endModel()
    return model


def points(vertices):
    out = coal.StdVec_Vec3s()
    for v in vertices:
        out.append(v)
    return out


class Job:
    def __init__(self, folder):
        self.geometries, self.pairs = [], []
        for line in open(os.path.join(folder, "job.txt")):
            word, *rest = line.rstrip("\n").split("\t")
            if word == "urdf":
                self.urdf = rest[0]
            elif word == "joints":
                self.joints = [name for name in rest if name]
            elif word == "states":
                self.count = int(rest[0])
            elif word == "whole":
                self.whole = int(rest[0])
            elif word == "pair":
                self.pairs.append(tuple(int(n) for n in rest))
            elif word == "geometry":
                self.geometries.append((rest[0], rest[1], [float(x) for x in rest[2:]]))
        self.binary = open(os.path.join(folder, "job.bin"), "rb").read()
        self.at = 0

    def take(self, count, kind):
        values = np.frombuffer(self.binary, dtype=kind, count=count, offset=self.at)
        self.at += values.nbytes
        return values

    def shape(self, kind, numbers):
        """The shape, and half the size of a box around it with its middle."""
        if kind == "box":
            return coal.Box(*numbers), np.array(numbers) / 2, np.zeros(3)
        if kind == "sphere":
            return coal.Sphere(*numbers), np.full(3, numbers[0]), np.zeros(3)
        if kind == "cylinder":
            r, height = numbers
            return coal.Cylinder(r, height), np.array([r, r, height / 2]), np.zeros(3)
        if kind == "capsule":
            r, height = numbers
            return coal.Capsule(r, height), np.array([r, r, height / 2 + r]), np.zeros(3)
        corners, triangles = (int(n) for n in numbers)
        vertices = self.take(3 * corners, "<f8").reshape(-1, 3).copy()
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        return mesh(vertices, self.take(3 * triangles, "<u4").reshape(-1, 3)), (high - low) / 2, (high + low) / 2


def build(job):
    model = pin.buildModelFromUrdf(job.urdf)
    solids, boxes = pin.GeometryModel(), []
    for i, (link, kind, numbers) in enumerate(job.geometries):
        rows = np.eye(4)
        rows[:3] = np.array(numbers[-12:]).reshape(3, 4)
        shape, half, middle = job.shape(kind, numbers[:-12])
        boxes.append((half, middle))
        joint, frame, placement = 0, 0, pin.SE3(rows)
        if link:
            frame = model.getFrameId(link, pin.FrameType.BODY)
            assert frame < model.nframes, f"Pinocchio knows no link {link}"
            joint = model.frames[frame].parentJoint
            placement = model.frames[frame].placement * placement
        solids.addGeometryObject(pin.GeometryObject(str(i), joint, frame, placement, shape))
    for a, b, _ in job.pairs:
        solids.addCollisionPair(pin.CollisionPair(a, b))
    return model, solids, boxes


class Bounded:
    """The least distance over the queried pairs: Coal measures each pair within the least so far.

    A DistanceResult whose min_distance is set is a limit to Coal's search: what is farther is left out. Pairs are queried
    in the order of the gaps of the boxes around them, until a gap exceeds the least; a gap is never above the distance.
    """

    def __init__(self, job, solids, boxes, request):
        queried = [(a, b) for a, b, is_queried in job.pairs if is_queried]
        self.a, self.b = (np.array([pair[i] for pair in queried], dtype=int) for i in (0, 1))
        shapes = [solid.geometry for solid in solids.geometryObjects]
        self.measure = [coal.ComputeDistance(shapes[a], shapes[b]) for a, b in queried]
        self.half, self.middle = (np.array([box[i] for box in boxes]) for i in (0, 1))
        self.request, self.result = request, coal.DistanceResult()

    def least(self, placements, known):
        if known <= 0.0 or not self.measure:
            return known
        rotations = np.array([p.rotation for p in placements])
        shifts = np.array([p.translation for p in placements])
        middle = np.einsum("nij,nj->ni", rotations, self.middle) + shifts
        half = np.einsum("nij,nj->ni", np.abs(rotations), self.half)
        apart = np.abs(middle[self.a] - middle[self.b]) - half[self.a] - half[self.b]
        # The last term is far above what rounding adds.
        gaps = np.linalg.norm(np.maximum(apart, 0.0), axis=1) - 1e-9 * (1.0 + np.abs(middle).max() + half.max())
        poses = [None] * len(placements)
        least = known
        for k in np.argsort(gaps):
            if gaps[k] > least or least <= 0.0:
                break
            a, b = self.a[k], self.b[k]
            for i in (a, b):
                poses[i] = poses[i] or coal.Transform3s(rotations[i], shifts[i])
            self.result.clear()
            self.result.min_distance = least
            self.measure[k](poses[a], poses[b], self.request, self.result)
            least = min(least, self.result.min_distance)
        return least


def configurations(job, model, states):
    """Pinocchio's configuration of each state, a row each."""
    joints = ET.parse(job.urdf).getroot().findall("joint")
    mimics = {j.get("name"): j.find("mimic") for j in joints if j.find("mimic") is not None}
    free = dict(zip(job.joints, states.T))
    q = np.zeros((len(states), model.nq))
    for i in range(1, model.njoints):
        joint, value = model.joints[i], joint_value(model.names[i], mimics, free)
        # Continuous joints are a point on the unit circle.
        parts = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        for k, part in enumerate(parts):
            q[:, joint.idx_q + k] = part
    return q


def main():
    folder = sys.argv[1]
    job = Job(folder)
    states = job.take(job.count * len(job.joints), "<f8").reshape(job.count, -1)
    model, solids, boxes = build(job)
    data, solid_data, as_it_comes = model.createData(), solids.createData(), solids.createData()
    # Tighter than its default, which is good to a micrometre: for pairs with a primitive, and for contacts of meshes,
    # whose triangles Coal measures by GJK as well when it tests whether they touch.
    for request in [*solid_data.distanceRequests, *solid_data.collisionRequests]:
        request.gjk_tolerance = 1e-10
        request.gjk_max_iterations = 1000
    for request in solid_data.distanceRequests:
        # No depth of penetration: contact is 0.
        request.enable_signed_distance = False
    bounded = Bounded(job, solids, boxes, solid_data.distanceRequests[0])
    known = os.path.join(folder, "known.bin")
    known = np.fromfile(known, dtype="<f8") if os.path.exists(known) else np.full(job.count, np.inf)
    whole = min(job.whole, job.count)
    least, of_all = np.zeros(job.count), np.zeros(whole)
    collides = np.zeros(job.count, dtype=np.uint8)
    spent = [0.0, 0.0, 0.0]
    clock = time.perf_counter
    for i, q in enumerate(configurations(job, model, states)):
        if i < whole:
            begin = clock()
            pin.computeDistances(model, data, solids, solid_data, q)
            spent[0] += clock() - begin
            of_all[i] = min(result.min_distance for result in solid_data.distanceResults)
            begin = clock()
            pin.computeCollisions(model, data, solids, as_it_comes, q, True)
            spent[1] += clock() - begin
        collides[i] = pin.computeCollisions(model, data, solids, solid_data, q, True)
        begin = clock()
        pin.updateGeometryPlacements(model, data, solids, solid_data, q)
        least[i] = bounded.least(solid_data.oMg, known[i])
        spent[2] += clock() - begin
    least.tofile(os.path.join(folder, "least.bin"))
    of_all.tofile(os.path.join(folder, "whole.bin"))
    collides.tofile(os.path.join(folder, "collides.bin"))
    print(*(1e6 * s / max(n, 1) for s, n in zip(spent, (whole, whole, job.count))))


if __name__ == "__main__":
    main()
