"""plainmp: spheres, true cylinders. RRT-Connect, 32 states per radian as in its author's comparison with VAMP.

With `--program FILE` its spheres are the collision spheres of that URDF (VAMP's); else its own, which are too thick at the
fingers for any goal of these problems. The pairs of links are its own in both cases.
"""

import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from plainmp.constraint import SphereAttachmentSpec
from plainmp.ompl_solver import OMPLSolver, OMPLSolverConfig, set_log_level_none, set_random_seed, simplify_path
from plainmp.problem import Problem
from plainmp.psdf import BoxSDF, CylinderSDF, Pose, SphereSDF, UnionSDF
from plainmp.robot_spec import PandaSpec

import attempts
import job

RESOLUTION = 1.0 / 32.0


class Panda(PandaSpec):
    """With the URDF that is given; plainmp's own would be downloaded."""

    def __init__(self, urdf):
        self.urdf = Path(urdf)
        super().__init__()

    def urdf_path_override(self):
        return self.urdf


class OtherSpheres(Panda):
    """With the spheres of another URDF."""

    def __init__(self, urdf, spheres):
        self.spheres = spheres_of(spheres)
        super().__init__(urdf)

    def parse_sphere_specs(self):
        # What stands in the world is no pair with it.
        return [
            SphereAttachmentSpec(link, np.array(centres).T, np.array(radii), link == "panda_link0")
            for link, (centres, radii) in self.spheres.items()
        ]

    def get_self_collision_pairs(self):
        # The hand has the spheres that are link 8's in its own model.
        return [[name.replace("link8", "hand") for name in pair] for pair in super().get_self_collision_pairs()]


def spheres_of(urdf):
    """Of each link that has spheres: centres and radii."""
    found = {}
    for link in ET.parse(urdf).getroot().findall("link"):
        for body in link.findall("collision"):
            sphere, origin = body.find("geometry/sphere"), body.find("origin")
            if sphere is not None:
                centres, radii = found.setdefault(link.get("name"), ([], []))
                centres.append([float(x) for x in origin.get("xyz").split()])
                radii.append(float(sphere.get("radius")))
    return found


def distances(solid):
    pose = Pose(solid.pose[:3, 3], solid.pose[:3, :3])
    makers = {"box": lambda *size: BoxSDF(np.array(size), pose), "sphere": lambda r: SphereSDF(r, pose)}
    makers["cylinder"] = lambda radius, length: CylinderSDF(radius, length, pose)
    return makers[solid.kind](*solid.sizes)


def attempt(spec, problem, seed):
    joints = spec.control_joint_names
    spec.reflect_joint_positions({name: x for name, x in problem.start.items() if name not in joints})
    start, goal = (np.array([table[name] for name in joints]) for table in (problem.start, problem.goal))
    constraint = spec.create_collision_const()
    constraint.set_sdf(UnionSDF([distances(solid) for solid in problem.solids]))
    low, high = spec.angle_bounds()
    inside = all(np.all(low <= q) and np.all(q <= high) for q in (start, goal))
    valid = inside and constraint.is_valid(start) and constraint.is_valid(goal)
    record = attempts.unsolved(problem, seed, valid, joints)
    if not valid:
        return record
    asked = Problem(start, low, high, goal, constraint, None, RESOLUTION, "euclidean")
    answer = OMPLSolver(OMPLSolverConfig(timeout=10.0)).solve(asked)
    if not answer.success:
        return record
    began = time.perf_counter()
    short = simplify_path(answer.traj, low, high, constraint, RESOLUTION, "euclidean")
    spent = time.perf_counter() - began
    raw, path = (trajectory.numpy().tolist() for trajectory in (answer.traj, short))
    return record | {
        "solved": True,
        "planning_us": answer.ns_internal / 1e3,
        "simplify_us": spent * 1e6,
        "cost_raw": attempts.length(raw),
        "cost": attempts.length(path),
        "path": path,
    }


def main():
    task = job.read()
    if any(not name.startswith("panda_joint") for problem in task.problems for name in problem.joints()):
        sys.exit("plainmp needs spheres of the robot; those of the Panda are the ones used here")
    set_log_level_none()
    set_random_seed(task.seed + 1)
    spec = OtherSpheres(task.urdf, task.program) if task.program else Panda(task.urdf)
    attempts.write(task.out, [attempt(spec, problem, task.seed) for problem in task.problems])


if __name__ == "__main__":
    main()
