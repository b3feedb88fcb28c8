"""Models of pinocchio as URDF and SRDF.

A link per joint: the body that moves with it, with all solids that pinocchio attaches to that joint. Frames that do not move
against it are part of it.
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
from elbowroom.optional import imported

__all__ = ["write_pinocchio"]

_AXES = {"X": [1.0, 0.0, 0.0], "Y": [0.0, 1.0, 0.0], "Z": [0.0, 0.0, 1.0]}


def write_pinocchio(model: Any, geometry: Any, folder: Path) -> None:
    """Write a `pinocchio.Model`, and the solids of its `GeometryModel`, to `robot.urdf` and `robot.srdf`."""
    links = _links(model)
    robot = Element("robot", name=model.name or "robot")
    bodies = [SubElement(robot, "link", name=name) for name in links]
    for number, solid in enumerate([] if geometry is None else geometry.geometryObjects):
        element = SubElement(bodies[solid.parentJoint], "collision")
        _origin(element, solid.placement)
        _solid(SubElement(element, "geometry"), solid, folder / f"solid_{number}.obj")
    for index in range(1, model.njoints):
        _joint(robot, model, index, links)
    ElementTree.ElementTree(robot).write(folder / "robot.urdf", encoding="utf-8", xml_declaration=True)
    if geometry is not None and len(geometry.collisionPairs):
        _write_srdf(geometry, links, folder / "robot.srdf", robot.get("name", ""))


def _links(model: Any) -> list[str]:
    """Return a name per joint: that of the first body that moves with it."""
    names: dict[int, str] = {}
    for frame in model.frames:
        if str(frame.type) == "BODY":
            names.setdefault(int(frame.parentJoint), frame.name)
    names.setdefault(0, "universe")
    links = [names.get(index, f"{model.names[index]}_link") for index in range(model.njoints)]
    for index, name in enumerate(links):
        if name in links[:index]:
            links[index] = f"{name}_{index}"
    return links


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
        ends = [model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]]
        lower, upper = sorted(scaling * value + offset for value in ends)
        if np.isfinite([lower, upper]).all():
            rates |= {"lower": lower, "upper": upper}
        elif kind == "prismatic":
            raise ArgumentError(f'joint "{name}" slides without limits\n  write: finite position limits')
        else:
            element.set("type", "continuous")
    SubElement(element, "limit", {key: repr(float(value)) for key, value in rates.items() if np.isfinite(value)})
    if is_mimic:
        SubElement(element, "mimic", joint=_leader(model, joint), multiplier=repr(scaling), offset=repr(offset))


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
    if kind == "Box":
        SubElement(element, "box", size=_text(2.0 * np.asarray(shape.halfSide)))
    elif kind == "Sphere":
        SubElement(element, "sphere", radius=repr(float(shape.radius)))
    elif kind in ("Cylinder", "Capsule"):
        length = repr(2.0 * float(shape.halfLength))
        SubElement(element, kind.lower(), radius=repr(float(shape.radius)), length=length)
    elif hasattr(shape, "vertices") and hasattr(shape, "tri_indices"):
        corners = [[t[0], t[1], t[2]] for t in (shape.tri_indices(k) for k in range(shape.num_tris))]
        _write_obj(np.asarray(shape.vertices()), corners, file)
        SubElement(element, "mesh", filename=file.name)
    elif hasattr(shape, "points") and hasattr(shape, "polygons"):
        corners = [[t[0], t[1], t[2]] for t in (shape.polygons(k) for k in range(shape.num_polygons))]
        _write_obj(np.asarray(shape.points()), corners, file)
        SubElement(element, "mesh", filename=file.name)
    else:
        hint = "boxes, spheres, cylinders, capsules and meshes"
        raise ArgumentError(f'the solid "{solid.name}" is a {kind}\n  write: {hint}')


def _write_obj(vertices: npt.NDArray[np.float64], corners: list[list[int]], file: Path) -> None:
    lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in corners]
    file.write_text("".join(lines), encoding="ascii")


def _write_srdf(geometry: Any, links: list[str], file: Path, name: str) -> None:
    """Disable the pairs of links none of whose solids are compared."""
    solids = [solid.parentJoint for solid in geometry.geometryObjects]
    compared = {frozenset((solids[pair.first], solids[pair.second])) for pair in geometry.collisionPairs}
    root = Element("robot", name=name)
    for a, b in itertools.combinations(sorted(set(solids)), 2):
        if frozenset((a, b)) not in compared:
            SubElement(root, "disable_collisions", link1=links[a], link2=links[b], reason="pinocchio")
    ElementTree.ElementTree(root).write(file, encoding="utf-8", xml_declaration=True)


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
