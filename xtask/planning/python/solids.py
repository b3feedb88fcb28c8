"""A robot among primitives, by Pinocchio and Coal: true meshes, true cylinders."""

import os
import xml.etree.ElementTree as ET

import coal
import numpy as np
import pinocchio as pin


class Robot:
    """What stays the same over all problems: model, meshes, and the pairs that the SRDF leaves."""

    def __init__(self, urdf, srdf=None):
        self.model = pin.buildModelFromUrdf(urdf)
        self.shapes = pin.buildGeomFromUrdf(self.model, urdf, pin.GeometryType.COLLISION, package_dirs=[os.path.dirname(urdf)])
        self.links = [self.model.frames[body.parentFrame].name for body in self.shapes.geometryObjects]
        self.pairs = self.own_pairs(disabled(srdf) if srdf else set())
        self.index = {self.model.names[i]: self.model.joints[i].idx_q for i in range(1, self.model.njoints)}
        boxes = [body.geometry for body in self.shapes.geometryObjects]
        for box in boxes:
            box.computeLocalAABB()
        self.half = np.array([(box.aabb_local.max_ - box.aabb_local.min_) / 2 for box in boxes])
        self.middle = np.array([(box.aabb_local.max_ + box.aabb_local.min_) / 2 for box in boxes])

    def own_pairs(self, skipped):
        parents = [body.parentJoint for body in self.shapes.geometryObjects]
        return [
            (a, b)
            for a in range(len(parents))
            for b in range(a + 1, len(parents))
            if parents[a] != parents[b]
            and self.model.parents[parents[b]] != parents[a]
            and self.model.parents[parents[a]] != parents[b]
            and frozenset((self.links[a], self.links[b])) not in skipped
        ]

    def values(self, *tables):
        """Pinocchio's configuration from tables of joint values; later tables win. Beyond the limits is taken as it is."""
        q = pin.neutral(self.model)
        for table in tables:
            for name, value in table.items():
                if name in self.index:
                    q[self.index[name]] = value
        return q

    def reach(self):
        """Per configuration number: no point of the robot is farther than this from that joint's axis, in any state."""
        steps = [np.linalg.norm(self.model.jointPlacements[i].translation) for i in range(self.model.njoints)]
        size = np.zeros(self.model.njoints)
        for body, half, middle in zip(self.shapes.geometryObjects, self.half, self.middle):
            far = np.linalg.norm(half) + np.linalg.norm(middle) + np.linalg.norm(body.placement.translation)
            size[body.parentJoint] = max(size[body.parentJoint], far)
        # Prismatic fingers lengthen the chain by at most what they travel; a decimetre is more than any gripper here.
        slack = [0.1 if self.model.joints[i].shortname().startswith("JointModelP") else 0.0 for i in range(self.model.njoints)]
        for i in reversed(range(1, self.model.njoints)):
            parent = self.model.parents[i]
            size[parent] = max(size[parent], steps[i] + slack[i] + size[i])
        out = np.zeros(self.model.nq)
        for i in range(1, self.model.njoints):
            prismatic = self.model.joints[i].shortname().startswith("JointModelP")
            out[self.model.joints[i].idx_q] = 1.0 if prismatic else size[i]
        return out


def disabled(srdf):
    entries = ET.parse(srdf).getroot().findall("disable_collisions")
    return {frozenset((entry.get("link1"), entry.get("link2"))) for entry in entries}


def shape(solid):
    """Coal's shape of a primitive; `sizes` as in `problems.Solid`."""
    makers = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}
    return makers[solid.kind](*(float(x) for x in solid.sizes))


class Cell:
    """One robot among the solids of one problem."""

    def __init__(self, robot, solids, allowed=frozenset()):
        self.robot, self.data, self.placed = robot, robot.model.createData(), robot.shapes.createData()
        count = len(robot.links)
        shapes = [body.geometry for body in robot.shapes.geometryObjects] + [shape(solid) for solid in solids]
        names = robot.links + [solid.name for solid in solids]
        pairs = robot.pairs + [
            # A link that no joint moves stands in the world like the solids.
            (a, count + k) for a in range(count) if robot.shapes.geometryObjects[a].parentJoint > 0 for k in range(len(solids))
        ]
        pairs = [(a, b) for a, b in pairs if frozenset((names[a], names[b])) not in allowed]
        self.names, self.pairs = names, pairs
        self.a, self.b = (np.array([pair[i] for pair in pairs], dtype=int) for i in (0, 1))
        # Coal's queries do not keep their shapes alive.
        self.shapes = shapes
        self.measures = [coal.ComputeDistance(shapes[a], shapes[b]) for a, b in pairs]
        self.touches = [coal.ComputeCollision(shapes[a], shapes[b]) for a, b in pairs]
        self.rotations = np.array([np.eye(3)] * count + [solid.pose[:3, :3] for solid in solids])
        self.shifts = np.array([np.zeros(3)] * count + [solid.pose[:3, 3] for solid in solids])
        still = [half_box(solid) for solid in solids]
        self.half = np.array([*robot.half, *still])
        self.middle = np.array([*robot.middle, *(np.zeros(3) for _ in solids)])
        self.poses = [None] * count + [coal.Transform3s(solid.pose[:3, :3], solid.pose[:3, 3]) for solid in solids]
        self.distance_request, self.distance_result = coal.DistanceRequest(), coal.DistanceResult()
        self.distance_request.enable_signed_distance = False
        self.collision_request, self.collision_result = coal.CollisionRequest(), coal.CollisionResult()

    def place(self, q):
        """Moves the robot; gives of every pair how far the boxes around the two are apart at least."""
        robot = self.robot
        pin.updateGeometryPlacements(robot.model, self.data, robot.shapes, self.placed, q)
        for i, pose in enumerate(self.placed.oMg):
            self.rotations[i], self.shifts[i] = pose.rotation, pose.translation
            self.poses[i] = None
        middle = np.einsum("nij,nj->ni", self.rotations, self.middle) + self.shifts
        half = np.einsum("nij,nj->ni", np.abs(self.rotations), self.half)
        apart = np.abs(middle[self.a] - middle[self.b]) - half[self.a] - half[self.b]
        return np.sqrt((np.maximum(apart, 0.0) ** 2).sum(axis=1)) - 1e-9

    def pose(self, i):
        if self.poses[i] is None:
            self.poses[i] = coal.Transform3s(self.rotations[i], self.shifts[i])
        return self.poses[i]

    def collides(self, q):
        """The first pair that touches, or None."""
        for k in np.nonzero(self.place(q) <= 0.0)[0]:
            self.collision_result.clear()
            a, b = self.a[k], self.b[k]
            if self.touches[k](self.pose(a), self.pose(b), self.collision_request, self.collision_result):
                return self.names[a], self.names[b]
        return None

    def clearance(self, q, enough):
        """A lower bound of the distance, exact where it is below `enough`; 0 on contact. Nearest boxes first."""
        gaps = self.place(q)
        least = enough
        for k in np.argsort(gaps):
            if gaps[k] >= least:
                break
            a, b = self.a[k], self.b[k]
            self.distance_result.clear()
            self.distance_result.min_distance = least
            self.measures[k](self.pose(a), self.pose(b), self.distance_request, self.distance_result)
            least = min(least, self.distance_result.min_distance)
            if least <= 0.0:
                return 0.0
        return least


def half_box(solid):
    if solid.kind == "box":
        return np.array(solid.sizes) / 2
    if solid.kind == "sphere":
        return np.full(3, solid.sizes[0])
    radius, length = solid.sizes
    return np.array([radius, radius, length / 2])
