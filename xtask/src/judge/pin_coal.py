"""Distances and collisions of a robot by Pinocchio and Coal, for `cargo xtask judge`.

usage: pin_coal.py FOLDER

FOLDER/job.txt says what there is, a line each, words apart by tabs:
  urdf PATH | joints NAME… | states COUNT | pair I J
  geometry LINK KIND NUMBERS… POSE (12 numbers, rows of 3x4): box x y z | sphere r | cylinder r height | mesh NV NT
  LINK is empty for what stands in the world.
FOLDER/job.bin holds the states (f64), then of each mesh its corners (f64) and triangles (u32).
Written: FOLDER/distances.bin (f64, states x pairs) and FOLDER/collides.bin (u8 per state). Printed: microseconds per
state of computeDistances and of computeCollisions, which stops at the first contact; both move the robot first.
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
            elif word == "pair":
                self.pairs.append((int(rest[0]), int(rest[1])))
            elif word == "geometry":
                self.geometries.append((rest[0], rest[1], [float(x) for x in rest[2:]]))
        self.binary = open(os.path.join(folder, "job.bin"), "rb").read()
        self.at = 0

    def take(self, count, kind):
        values = np.frombuffer(self.binary, dtype=kind, count=count, offset=self.at)
        self.at += values.nbytes
        return values

    def shape(self, kind, numbers):
        if kind == "box":
            return coal.Box(*numbers)
        if kind == "sphere":
            return coal.Sphere(*numbers)
        if kind == "cylinder":
            return coal.Cylinder(*numbers)
        corners, triangles = (int(n) for n in numbers)
        vertices = self.take(3 * corners, "<f8").reshape(-1, 3).copy()
        return mesh(vertices, self.take(3 * triangles, "<u4").reshape(-1, 3))


def build(job):
    model = pin.buildModelFromUrdf(job.urdf)
    solids = pin.GeometryModel()
    for i, (link, kind, numbers) in enumerate(job.geometries):
        rows = np.eye(4)
        rows[:3] = np.array(numbers[-12:]).reshape(3, 4)
        shape = job.shape(kind, numbers[:-12])
        joint, frame, placement = 0, 0, pin.SE3(rows)
        if link:
            frame = model.getFrameId(link, pin.FrameType.BODY)
            assert frame < model.nframes, f"Pinocchio knows no link {link}"
            joint = model.frames[frame].parentJoint
            placement = model.frames[frame].placement * placement
        solids.addGeometryObject(pin.GeometryObject(str(i), joint, frame, placement, shape))
    for a, b in job.pairs:
        solids.addCollisionPair(pin.CollisionPair(a, b))
    return model, solids


def configurations(job, model, states):
    joints = ET.parse(job.urdf).getroot().findall("joint")
    mimics = {j.get("name"): j.find("mimic") for j in joints if j.find("mimic") is not None}
    for state in states:
        free = dict(zip(job.joints, state))
        q = np.zeros(model.nq)
        for i in range(1, model.njoints):
            joint, value = model.joints[i], joint_value(model.names[i], mimics, free)
            # Continuous joints are a point on the unit circle.
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        yield q


def main():
    folder = sys.argv[1]
    job = Job(folder)
    states = job.take(job.count * len(job.joints), "<f8").reshape(job.count, -1)
    model, solids = build(job)
    data, solid_data = model.createData(), solids.createData()
    for request in solid_data.distanceRequests:
        # No depth of penetration: contact is 0. Tighter than its default, for pairs with a primitive.
        request.enable_signed_distance = False
        request.gjk_tolerance = 1e-10
        request.gjk_max_iterations = 1000
    distances = np.zeros((job.count, len(job.pairs)))
    collides = np.zeros(job.count, dtype=np.uint8)
    spent = [0.0, 0.0]
    clock = time.perf_counter
    for i, q in enumerate(configurations(job, model, states)):
        begin = clock()
        pin.computeDistances(model, data, solids, solid_data, q)
        middle = clock()
        collides[i] = pin.computeCollisions(model, data, solids, solid_data, q, True)
        spent[0] += middle - begin
        spent[1] += clock() - middle
        distances[i] = [result.min_distance for result in solid_data.distanceResults]
    distances.tofile(os.path.join(folder, "distances.bin"))
    collides.tofile(os.path.join(folder, "collides.bin"))
    print(*(1e6 * s / max(job.count, 1) for s in spent))


main()
