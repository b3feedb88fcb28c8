"""Models of pinocchio as URDF and SRDF.

A link per body, where its frame is; the first body that moves with a joint carries the others. Solids are in the link of the frame
that they belong to.
"""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError
from elbowroom.files import obj
from elbowroom.optional import imported

__all__ = ["write_pinocchio"]

#: Limits from here on are none: pinocchio has the largest number where a joint has no limit.
_UNLIMITED = 1e300

_AXES = {"X": [1.0, 0.0, 0.0], "Y": [0.0, 1.0, 0.0], "Z": [0.0, 0.0, 1.0]}


def write_pinocchio(model: Any, geometry: Any, folder: Path) -> None:
    """Write a `pinocchio.Model`, and the solids of its `GeometryModel`, to `robot.urdf` and `robot.srdf`."""
    links = _Links(model)
    robot = Element("robot", name=model.name or "robot")
    elements = {name: SubElement(robot, "link", name=name) for name in links.names}
    solids = [] if geometry is None else [solid for solid in geometry.geometryObjects if not solid.disableCollision]
    for number, solid in enumerate(solids):
        name, placement = links.of_solid(solid)
        element = SubElement(elements[name], "collision")
        _origin(element, placement)
        _solid(SubElement(element, "geometry"), solid, folder / f"solid_{number}.obj")
    for name, (carrier, placement) in links.fixed.items():
        element = SubElement(robot, "joint", name=f"{name}_fixed", type="fixed")
        SubElement(element, "parent", link=carrier)
        SubElement(element, "child", link=name)
        _origin(element, placement)
    for index in range(1, model.njoints):
        _joint(robot, model, index, links.main)
    ElementTree.ElementTree(robot).write(folder / "robot.urdf", encoding="utf-8", xml_declaration=True)
    if geometry is not None and len(geometry.collisionPairs):
        _write_srdf(model, geometry, links, folder / "robot.srdf", robot.get("name", ""))


class _Links:
    """Links of a model, by their names."""

    def __init__(self, model: Any) -> None:
        self._model = model
        #: Per joint the link that moves with it.
        self.main: list[str] = []
        #: Other bodies: the link that carries each, and where.
        self.fixed: dict[str, tuple[str, Any]] = {}
        #: Per index of a frame its link.
        self._of_frame: dict[int, str] = {}
        bodies = [(index, frame) for index, frame in enumerate(model.frames) if str(frame.type) == "BODY"]
        for joint in range(model.njoints):
            own = [(index, frame) for index, frame in bodies if frame.parentJoint == joint and frame.placement.isIdentity(1e-12)]
            name = self._new(own[0][1].name if own else f"{model.names[joint]}_link")
            self.main.append(name)
            if own:
                self._of_frame[own[0][0]] = name
        for index, frame in bodies:
            if index not in self._of_frame:
                name = self._of_frame[index] = self._new(frame.name)
                self.fixed[name] = (self.main[frame.parentJoint], frame.placement)

    @property
    def names(self) -> list[str]:
        return [*self.main, *self.fixed]

    def _new(self, name: str) -> str:
        """Return the name, with a number if another link has it."""
        taken, number, found = set(self.names), 2, name
        while found in taken:
            found, number = f"{name}_{number}", number + 1
        return found

    def of_solid(self, solid: Any) -> tuple[str, Any]:
        """Return the link of a solid, and where the solid is in it."""
        if solid.parentJoint >= self._model.njoints:
            raise ArgumentError(f'the solid "{solid.name}" is of joint {solid.parentJoint}\n  write: the geometry of this model')
        name = self._of_frame.get(solid.parentFrame)
        if name is not None and self._model.frames[solid.parentFrame].parentJoint == solid.parentJoint:
            return name, self._model.frames[solid.parentFrame].placement.inverse() * solid.placement
        return self.main[solid.parentJoint], solid.placement


def _joint(robot: Element, model: Any, index: int, links: list[str]) -> None:
    joint, name = model.joints[index], model.names[index]
    is_mimic = joint.shortname() == "JointModelMimic"
    kind, axis = _mimic_motion(model, index) if is_mimic else _motion(joint, name)
    scaling, offset = (joint.extract().scaling, joint.extract().offset) if is_mimic else (1.0, 0.0)
    element = SubElement(robot, "joint", name=name, type=kind)
    SubElement(element, "parent", link=links[model.parents[index]])
    SubElement(element, "child", link=links[index])
    _origin(element, model.jointPlacements[index])
    SubElement(element, "axis", xyz=_text(axis))
    rates = {"effort": model.effortLimit[joint.idx_v], "velocity": abs(scaling) * model.velocityLimit[joint.idx_v]}
    if kind != "continuous":
        ends = _position_limits(model, joint, name)
        if ends is not None:
            lower, upper = sorted(scaling * value + offset for value in ends)
            rates |= {"lower": lower, "upper": upper}
        elif kind == "prismatic":
            raise ArgumentError(f'joint "{name}" slides without limits\n  write: finite position limits')
        else:
            element.set("type", "continuous")
    SubElement(element, "limit", {key: repr(float(value)) for key, value in rates.items() if abs(value) < _UNLIMITED})
    if is_mimic:
        SubElement(element, "mimic", joint=_leader(model, joint), multiplier=repr(scaling), offset=repr(offset))


def _position_limits(model: Any, joint: Any, name: str) -> tuple[float, float] | None:
    """Return the limits of a joint, or `None` without any."""
    lower, upper = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
    if lower <= -_UNLIMITED and upper >= _UNLIMITED:
        return None
    if not (-_UNLIMITED < lower <= upper < _UNLIMITED):
        raise ArgumentError(f'joint "{name}" has the limits {lower} and {upper}\n  write: two finite ones, or none')
    return lower, upper


def _leader(model: Any, mimic: Any) -> str:
    """Return the joint that another one follows: they have the same place in a state."""
    of = (n for n in range(1, model.njoints) if model.joints[n].shortname() != "JointModelMimic" and model.joints[n].idx_q == mimic.idx_q)
    name: str = model.names[next(of)]
    return name


def _motion(joint: Any, name: str) -> tuple[str, npt.ArrayLike]:
    """Return the type of a joint in URDF, and its axis."""
    short = joint.shortname()
    found = re.fullmatch(r"JointModel(R|P|RUB)([XYZ])", short)
    if found:
        return {"R": "revolute", "P": "prismatic", "RUB": "continuous"}[found[1]], _AXES[found[2]]
    kinds = {
        "JointModelRevoluteUnaligned": "revolute",
        "JointModelRevoluteUnboundedUnaligned": "continuous",
        "JointModelPrismaticUnaligned": "prismatic",
    }
    if short not in kinds:
        raise ArgumentError(f'joint "{name}" is a {short}\n  write: a model of joints that turn or slide about one axis')
    return kinds[short], joint.extract().axis


def _mimic_motion(model: Any, index: int) -> tuple[str, npt.ArrayLike]:
    """Return the type of a joint that follows another one, and its axis, from where it is at the values 0 and 1."""
    pinocchio = imported("pinocchio")
    joint, data = model.joints[index], model.createData()
    if joint.nq or model.joints[model.getJointId(_leader(model, joint))].nq != 1:
        raise ArgumentError(f'joint "{model.names[index]}" follows one that turns without end\n  write: a model without it')
    places = []
    for value in (0.0, 1.0):
        q = pinocchio.neutral(model)
        q[joint.idx_q] = (value - joint.extract().offset) / joint.extract().scaling
        pinocchio.forwardKinematics(model, data, q)
        places.append(data.liMi[index].copy())
    motion = pinocchio.log6(places[0].inverse() * places[1])
    turn = np.asarray(motion.angular)
    return ("revolute", turn) if np.linalg.norm(turn) > 0.5 else ("prismatic", np.asarray(motion.linear))


def _solid(element: Element, solid: Any, file: Path) -> None:
    shape = solid.geometry
    kind = type(shape).__name__
    if getattr(shape, "getSweptSphereRadius", lambda: 0.0)() > 0.0:
        raise ArgumentError(f'the solid "{solid.name}" has a swept sphere\n  write: a solid without, as large as both')
    if kind == "Box":
        SubElement(element, "box", size=_text(2.0 * np.asarray(shape.halfSide)))
    elif kind == "Sphere":
        SubElement(element, "sphere", radius=repr(float(shape.radius)))
    elif kind in ("Cylinder", "Capsule"):
        length = repr(2.0 * float(shape.halfLength))
        SubElement(element, kind.lower(), radius=repr(float(shape.radius)), length=length)
    elif hasattr(shape, "vertices") and hasattr(shape, "tri_indices"):
        _mesh(element, shape.vertices(), [shape.tri_indices(k) for k in range(shape.num_tris)], file)
    elif hasattr(shape, "points") and hasattr(shape, "polygons"):
        _mesh(element, shape.points(), [shape.polygons(k) for k in range(shape.num_polygons)], file)
    else:
        hint = "boxes, spheres, cylinders, capsules and meshes"
        raise ArgumentError(f'the solid "{solid.name}" is a {kind}\n  write: {hint}')


def _mesh(element: Element, vertices: Any, triangles: list[Any], file: Path) -> None:
    faces = np.array([[t[0], t[1], t[2]] for t in triangles], dtype=np.int64).reshape(-1, 3)
    file.write_bytes(obj(np.asarray(vertices), faces))
    SubElement(element, "mesh", filename=file.name)


def _write_srdf(model: Any, geometry: Any, links: _Links, file: Path, name: str) -> None:
    """Disable the pairs of links that are not compared. What is compared must be a pair here too."""
    solids = {index: solid for index, solid in enumerate(geometry.geometryObjects) if not solid.disableCollision}
    of = {index: links.of_solid(solid)[0] for index, solid in solids.items()}
    compared = {frozenset((pair.first, pair.second)) for pair in geometry.collisionPairs if pair.first in solids and pair.second in solids}
    by_links: dict[tuple[str, str], set[bool]] = {}
    for a, b in itertools.combinations(solids, 2):
        one, other = sorted((of[a], of[b]))
        by_links.setdefault((one, other), set()).add(frozenset((a, b)) in compared)
        if frozenset((a, b)) in compared and _are_neighbours(model, solids[a].parentJoint, solids[b].parentJoint):
            pair = f'"{solids[a].name}" and "{solids[b].name}"'
            hint = "geometry.removeCollisionPair(…) for neighbours; what stands around the robot in a Scene"
            raise ArgumentError(f"{pair} are compared, but at most one joint is between them, so they are not a pair here\n  write: {hint}")
    root = Element("robot", name=name)
    for (one, other), answers in by_links.items():
        if answers == {True, False} and one != other:
            hint = "all pairs of their solids, or none"
            raise ArgumentError(f'some solids of "{one}" and "{other}" are compared and others not\n  write: {hint}')
        if answers == {False} and one != other:
            SubElement(root, "disable_collisions", link1=one, link2=other, reason="pinocchio")
    ElementTree.ElementTree(root).write(file, encoding="utf-8", xml_declaration=True)


def _are_neighbours(model: Any, a: int, b: int) -> bool:
    """Return whether at most one joint is between two joints' bodies."""
    return a == b or model.parents[a] == b and a != 0 or model.parents[b] == a and b != 0


def _origin(element: Element, placement: Any) -> None:
    turn = np.asarray(placement.rotation)
    # About the fixed axes x, y, z; at the pole the turn about x is 0.
    pitch = np.arctan2(-turn[2, 0], np.hypot(turn[0, 0], turn[1, 0]))
    is_pole = np.hypot(turn[0, 0], turn[1, 0]) < 1e-12
    roll = 0.0 if is_pole else np.arctan2(turn[2, 1], turn[2, 2])
    yaw = np.arctan2(-turn[0, 1], turn[1, 1]) if is_pole else np.arctan2(turn[1, 0], turn[0, 0])
    SubElement(element, "origin", xyz=_text(placement.translation), rpy=_text([roll, pitch, yaw]))


def _text(values: npt.ArrayLike) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values))
