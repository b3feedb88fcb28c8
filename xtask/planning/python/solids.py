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

    def motion(self, i):
        """`r` or `p`, and the axis of a joint in its own frame."""
        joint = self.model.joints[i]
        if joint.nq != 1:
            raise ValueError(f"{self.model.names[i]}: only joints with limits are read")
        subspace = np.asarray(joint.createData().S).ravel()
        turns = np.linalg.norm(subspace[3:]) > 0.5
        return ("r", subspace[3:]) if turns else ("p", subspace[:3])

    def reach(self):
        """Per joint: no point of the robot moves faster than this when the joint moves by 1 (rad or m), in any state."""
        model = self.model
        steps = [np.linalg.norm(placement.translation) for placement in model.jointPlacements]
        # What a prismatic joint may lengthen the chain by.
        slides = [self.motion(i)[0] == "p" for i in range(1, model.njoints)]
        travel = [0.0] + [max(map(abs, self.limits(i))) + 0.1 if slide else 0.0 for i, slide in enumerate(slides, 1)]
        size = np.zeros(model.njoints)
        for body, half, middle in zip(self.shapes.geometryObjects, self.half, self.middle):
            far = np.linalg.norm(half) + np.linalg.norm(middle) + np.linalg.norm(body.placement.translation)
            size[body.parentJoint] = max(size[body.parentJoint], far)
        for i in reversed(range(1, model.njoints)):
            parent = model.parents[i]
            size[parent] = max(size[parent], steps[i] + travel[i] + size[i])
        return [0.0] + [1.0 if slide else size[i] for i, slide in enumerate(slides, 1)]

    def limits(self, i):
        at = self.model.joints[i].idx_q
        return self.model.lowerPositionLimit[at], self.model.upperPositionLimit[at]


def disabled(srdf):
    entries = ET.parse(srdf).getroot().findall("disable_collisions")
    return {frozenset((entry.get("link1"), entry.get("link2"))) for entry in entries}


def shape(solid):
    """Coal's shape of a primitive; `sizes` as in `problems.Solid`."""
    makers = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}
    return makers[solid.kind](*(float(x) for x in solid.sizes))


def pairs_among(robot, names, allowed):
    """What is tested: `names` are the robot's links, then the solids; `allowed` may touch."""
    count = len(robot.links)
    # A link that no joint moves stands in the world like the solids.
    moved = [a for a in range(count) if robot.shapes.geometryObjects[a].parentJoint > 0]
    pairs = robot.pairs + [(a, b) for a in moved for b in range(count, len(names))]
    return [(a, b) for a, b in pairs if frozenset((names[a], names[b])) not in allowed]


class Cell:
    """One robot among the solids of one problem."""

    def __init__(self, robot, solids, allowed=frozenset()):
        self.robot, self.data, self.placed = robot, robot.model.createData(), robot.shapes.createData()
        count = len(robot.links)
        shapes = [body.geometry for body in robot.shapes.geometryObjects] + [shape(solid) for solid in solids]
        names = robot.links + [solid.name for solid in solids]
        pairs = pairs_among(robot, names, allowed)
        self.names = names
        self.a, self.b = (np.array([pair[i] for pair in pairs], dtype=int) for i in (0, 1))
        # Coal's queries do not keep their shapes alive.
        self.shapes = shapes
        self.touches = [coal.ComputeCollision(shapes[a], shapes[b]) for a, b in pairs]
        self.rotations = np.array([np.eye(3)] * count + [solid.pose[:3, :3] for solid in solids])
        self.shifts = np.array([np.zeros(3)] * count + [solid.pose[:3, 3] for solid in solids])
        still = [half_box(solid) for solid in solids]
        self.half = np.array([*robot.half, *still])
        self.middle = np.array([*robot.middle, *(np.zeros(3) for _ in solids)])
        self.poses = [None] * count + [coal.Transform3s(solid.pose[:3, :3], solid.pose[:3, 3]) for solid in solids]
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


def half_box(solid):
    if solid.kind == "box":
        return np.array(solid.sizes) / 2
    if solid.kind == "sphere":
        return np.full(3, solid.sizes[0])
    radius, length = solid.sizes
    return np.array([radius, radius, length / 2])
