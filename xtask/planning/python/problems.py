"""Problems in MotionBenchMaker's layout, `{set: {id: {scene, request}}}`, as plain Python objects."""

import json
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Solid:
    """A primitive: `kind` is box (sizes x y z), sphere (radius) or cylinder (radius, length along z)."""

    name: str
    kind: str
    sizes: list
    pose: np.ndarray


@dataclass
class Problem:
    set: str
    id: str
    solids: list
    start: dict
    goal: dict
    allowed: set = field(default_factory=set)

    def arm(self, which):
        """Start or goal of the joints that the goal names, in the order of the start."""
        return [which[name] for name in self.joints()]

    def joints(self):
        return [name for name in self.start if name in self.goal]


def read(path):
    """Every problem of the file, in its order."""
    with open(path) as text:
        sets = json.load(text)
    return [problem(name, key, entry) for name, entries in sets.items() for key, entry in entries.items()]


def problem(name, key, entry):
    state = entry["request"]["start_state"]["joint_state"]
    start = dict(zip(state["name"], state["position"]))
    constraints = entry["request"]["goal_constraints"][0]["joint_constraints"]
    goal = {c["joint_name"]: c["position"] for c in constraints}
    solids = [solid for body in entry["scene"]["world"]["collision_objects"] for solid in parts(body)]
    return Problem(name, key, solids, start, goal, allowed(entry["scene"].get("allowed_collision_matrix")))


def parts(body):
    whole = matrix(body["pose"]) if "pose" in body else np.eye(4)
    if body.get("meshes"):
        raise ValueError(f"{body['id']}: meshes in a scene are not read")
    for primitive, pose in zip(body["primitives"], body["primitive_poses"]):
        kind, sizes = primitive["type"], list(primitive["dimensions"])
        if kind == "cylinder":
            sizes.reverse()
        elif kind not in ("box", "sphere"):
            raise ValueError(f"{body['id']}: the primitive `{kind}` is not known")
        yield Solid(body["id"], kind, sizes, whole @ matrix(pose))


def matrix(pose):
    out = np.eye(4)
    out[:3, :3] = rotation(pose["orientation"])
    out[:3, 3] = pose["position"]
    return out


def rotation(xyzw):
    x, y, z, w = np.array(xyzw, dtype=float) / np.linalg.norm(xyzw)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def allowed(acm):
    """The pairs of names whose collision the scene allows."""
    if not acm:
        return set()
    names = acm["entry_names"]
    rows = [row["enabled"] if isinstance(row, dict) else row for row in acm["entry_values"]]
    return {frozenset((a, b)) for a, row in zip(names, rows) for b, yes in zip(names, row) if yes and a != b}
