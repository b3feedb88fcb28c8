"""Models of other packages: trimesh, yourdfpy and pinocchio. None of them is required."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from elbowroom import _elbowroom
from elbowroom.columns import state
from elbowroom.errors import ArgumentError, FileError
from elbowroom.optional import imported
from elbowroom.pinocchio_model import write_pinocchio

if TYPE_CHECKING:
    from elbowroom.results import Mesh

__all__ = ["robot_of", "temporary_folder", "trimesh_of_cell", "trimesh_of_robot"]

#: Begin of the names of folders of robots of other packages.
_PREFIX = "elbowroom-robot-"


def trimesh_of_robot(robot: _elbowroom.Robot, q: npt.ArrayLike | None, kind: str) -> Any:
    """Return a robot as a `trimesh.Scene`."""
    at = np.clip(0.0, *robot.limits.T) if q is None else state(q, robot.joints)
    meshes = robot.meshes(kind)
    poses = {name: robot.fk(at[None, :], link=name)[0] for name in meshes}
    return _scene(meshes, poses)


def trimesh_of_cell(cell: _elbowroom.Cell, q: npt.ArrayLike | None) -> Any:
    """Return a cell as a `trimesh.Scene`."""
    at = cell.start if q is None else state(q, cell.joints)
    poses = {name: of[0] for name, of in cell.fk(at[None, :]).items()}
    return _scene(cell.meshes(), poses | cell.objects)


def _scene(meshes: Mapping[str, Mesh], poses: Mapping[str, npt.NDArray[np.float64]]) -> Any:
    trimesh = imported("trimesh")
    scene = trimesh.Scene()
    for name, mesh in meshes.items():
        # Vertices stay as they are: a solid is closed by shared vertices already, or not at all.
        triangles = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        scene.add_geometry(triangles, node_name=name, geom_name=name, transform=poses[name])
    return scene


def robot_of(model: Any, geometry: Any = None) -> _elbowroom.Robot:
    """Return the robot of a model of another package, from a folder that is removed with it."""
    if geometry is None and hasattr(model, "model") and hasattr(model, "collision_model"):
        model, geometry = model.model, model.collision_model  # A RobotWrapper of pinocchio.
    write = _writer(model, geometry)
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX)).resolve()
    try:
        write(folder)
        srdf = folder / "robot.srdf"
        robot = _elbowroom.Robot.load(folder / "robot.urdf", srdf if srdf.exists() else None)
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, FileError) and Path(error.file).is_relative_to(folder):
            # That file is gone.
            hint = f"\n  write: {error.hint}" if error.hint else ""
            raise ArgumentError(f"the model of {type(model).__module__.split('.')[0]} {error.message}{hint}") from None
        raise
    weakref.finalize(robot, shutil.rmtree, folder, ignore_errors=True)
    return robot


def temporary_folder(model: Path) -> Path | None:
    """Return the folder of the file of a robot if it is removed with the robot."""
    return model.parent if model.parent.name.startswith(_PREFIX) and model.name == "robot.urdf" else None


def _writer(model: Any, geometry: Any) -> Callable[[Path], None]:
    """Return what writes the URDF of a model to a folder; classes are known by their names, so that nothing is imported."""
    classes = {f"{kind.__module__.split('.')[0]}.{kind.__name__}" for kind in type(model).__mro__}
    if "yourdfpy.URDF" in classes and geometry is None:
        return lambda folder: _write_yourdfpy(model, folder)
    is_geometry = geometry is None or hasattr(geometry, "geometryObjects")
    if hasattr(model, "jointPlacements") and hasattr(model, "joints") and is_geometry:
        return lambda folder: write_pinocchio(model, geometry, folder)
    name = f"{type(model).__module__}.{type(model).__name__}"
    more = "" if geometry is None else f" with geometry of {type(geometry).__name__}"
    raise ArgumentError(f"a {name}{more} is not a robot\n  write: a yourdfpy.URDF, or a pinocchio.Model with its GeometryModel")


def _write_yourdfpy(model: Any, folder: Path) -> None:
    """Write a model of yourdfpy, whose meshes stay where it finds them."""
    root = ElementTree.fromstring(model.write_xml_string())
    leaders = {joint.name: joint.mimic for joint in model.robot.joints if joint.mimic is not None}
    for joint in root.iter("joint"):
        leader = leaders.get(joint.get("name", ""))
        # Some of its versions leave out which joint follows which.
        if leader is not None and joint.find("mimic") is None:
            values = {"multiplier": leader.multiplier, "offset": leader.offset}
            keys = {key: repr(float(value)) for key, value in values.items() if value is not None}
            ElementTree.SubElement(joint, "mimic", {"joint": leader.joint, **keys})
    for mesh in _meshes(root):
        name = mesh.get("filename", "")
        found = Path(str(model._filename_handler(name)))
        if not found.exists():
            hint = "yourdfpy.URDF.load(…, filename_handler=…), which returns where each mesh is"
            raise ArgumentError(f'yourdfpy does not find the mesh "{name}"\n  write: {hint}')
        mesh.set("filename", str(found.resolve()))
    ElementTree.ElementTree(root).write(folder / "robot.urdf", encoding="utf-8", xml_declaration=True)


def _meshes(root: ElementTree.Element) -> Iterator[ElementTree.Element]:
    return (mesh for mesh in root.iter("mesh") if mesh.get("filename"))
