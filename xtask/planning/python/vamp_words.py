"""A problem as the lines that `vamp_plan` reads, with VAMP's own substitutes for cylinders."""

import math
import os
import sys


def write(task):
    """Writes the problems to a file of the job's folder; returns its name."""
    if any(name != f"panda_joint{k}" for p in task.problems for k, name in enumerate(p.joints(), 1)):
        sys.exit("VAMP has compiled code for a few robots; the Panda is the one used here")
    scenes = os.path.join(task.folder, "vamp_problems.txt")
    with open(scenes, "w") as out:
        for problem in task.problems:
            out.write("\n".join(lines(problem)) + "\n")
    return scenes


def lines(problem):
    """The substitutes are those of VAMP's `problem_dict_to_vamp`: a box where the set is `box`, else a capsule."""
    out = [f"problem {problem.set} {problem.id}"]
    out.append(words("start", problem.arm(problem.start)))
    out.append(words("goal", problem.arm(problem.goal)))
    boxes = problem.set.replace("_panda", "") == "box"
    # VAMP adds them in this order.
    for kind in ("sphere", "cylinder", "box"):
        out += [solid_line(solid, boxes) for solid in problem.solids if solid.kind == kind]
    return out + ["end"]


def solid_line(solid, cylinders_are_boxes):
    place = [*solid.pose[:3, 3], *euler(solid.pose)]
    if solid.kind == "sphere":
        return words("sphere", [*place[:3], *solid.sizes])
    if solid.kind == "box":
        return words("cuboid", [*place, *(size / 2 for size in solid.sizes)])
    radius, length = solid.sizes
    if cylinders_are_boxes:
        return words("cuboid", [*place, radius, radius, length / 2])
    return words("capsule", [*place, radius, length])


def euler(pose):
    """Angles about the fixed axes x, y, z, in this order."""
    across = math.hypot(pose[0, 0], pose[1, 0])
    if across < 1e-12:
        return math.atan2(-pose[1, 2], pose[1, 1]), math.atan2(-pose[2, 0], across), 0.0
    return math.atan2(pose[2, 1], pose[2, 2]), math.atan2(-pose[2, 0], across), math.atan2(pose[1, 0], pose[0, 0])


def words(kind, numbers):
    return " ".join([kind, *(repr(float(x)) for x in numbers)])
