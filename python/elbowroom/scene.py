"""Scenes put together in Python: robots and objects at their places, as a cell or a cell file."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from elbowroom import poses
from elbowroom._elbowroom import Cell, Robot
from elbowroom.columns import real
from elbowroom.errors import ArgumentError, ArrayError, FileError
from elbowroom.files import obj, unwritable
from elbowroom.interop import temporary_folder
from elbowroom.pickles import files_of_robot
from elbowroom.poses import PoseLike

__all__ = ["MeshLike", "Scene"]

#: A mesh file; an object with `vertices` and `faces`, such as a `trimesh.Trimesh`; or `(vertices, faces)`. Metres.
MeshLike: TypeAlias = Any


class Scene:
    """Robots and objects at their places, without a file.

    `cell` makes a `Cell` of it, for checkers, planners, maps and runs; `save` writes the cell file, which regions and programs can be
    added to. Every table of the cell file can be set here too. Lengths are metres and angles radians. Other files are `pathlib.Path` objects:
    of the present folder, and relative to the cell file in it; text is written as it is.

    Parameters
    ----------
    name
        Name of the cell.
    keys
        Keys of the cell file outside of tables, such as `tick_ms=4` or `pairs=Path("pairs.csv")`.

    Examples
    --------
    >>> import numpy as np, elbowroom as er
    >>> scene = er.Scene()
    >>> scene.add_robot("arm", "examples/models/rx60b/rx60b.urdf")
    >>> scene.add_box("table", [0.6, 0.6, 0.1], ([0.5, 0.0, 0.1], [0, 0, 0, 1]))
    >>> er.Checker(scene.cell(), between="arm,table").distance(np.zeros((1, 6))).round(3).tolist()
    [0.104]
    >>> scene.move("table", ([1.5, 0.0, 0.1], [0, 0, 0, 1]))
    >>> er.Checker(scene.cell(), between="arm,table").distance(np.zeros((1, 6))).round(3).tolist()
    [1.088]
    """

    def __init__(self, name: str = "scene", **keys: Any) -> None:
        """Begin an empty scene."""
        self.name = name
        self._keys = _own(keys)
        self._tables: dict[str, dict[str, dict[str, Any]]] = {}
        self._robots: dict[str, Robot] = {}

    def add_robot(
        self,
        name: str,
        robot: Robot | str | os.PathLike[str],
        base: PoseLike | None = None,
        *,
        srdf: str | os.PathLike[str] | None = None,
        **keys: Any,
    ) -> None:
        """Add a robot.

        Parameters
        ----------
        name
            Its name in the scene.
        robot
            A `Robot`, or a file that `Robot.load` reads.
        base
            The pose of its root link in the world.
        srdf
            An SRDF: pairs of links that it disables are not tested. A `Robot` has its own.
        keys
            Further keys of `[robot.NAME]` in a cell file, such as `start=[0.0, 0.5, …]` or `flange="tool0"`.
        """
        if isinstance(robot, Robot):
            # The files of a robot of another package are there as long as it is.
            self._robots[name] = robot
            model, own_srdf, unit, joints = files_of_robot(robot)
        else:
            model, own_srdf, unit, joints = _absolute(robot), None, None, None
        given = {"model": model, "srdf": own_srdf if srdf is None else _absolute(srdf), "unit": unit, "joints": joints}
        table = {key: value for key, value in given.items() if value is not None}
        if base is not None:
            table["base"] = _pose(base)
        self.add("robot", name, **table | keys)

    def add_box(self, name: str, size_m: npt.ArrayLike, pose: PoseLike | None = None) -> None:
        """Add a box about its pose; `size_m` has the lengths of its edges."""
        self._object(name, pose, shape="box", size=_numbers("size_m", size_m, 3))

    def add_sphere(self, name: str, radius_m: float, center_m: npt.ArrayLike) -> None:
        """Add a sphere about a point."""
        self._object(name, None, shape="sphere", radius=radius_m, at=_numbers("center_m", center_m, 3))

    def add_cylinder(self, name: str, radius_m: float, height_m: float, pose: PoseLike | None = None) -> None:
        """Add a cylinder along z about its pose."""
        self._object(name, pose, shape="cylinder", radius=radius_m, height=height_m)

    def add_capsule(self, name: str, radius_m: float, height_m: float, pose: PoseLike | None = None) -> None:
        """Add a capsule along z about its pose; its height is without the caps."""
        self._object(name, pose, shape="capsule", radius=radius_m, height=height_m)

    def add_floor(self, name: str = "floor", height_m: float = 0.0) -> None:
        """Add everything below a height."""
        self._object(name, None, shape="plane", at=[0.0, 0.0, height_m])

    def add_mesh(self, name: str, mesh: MeshLike, pose: PoseLike | None = None) -> None:
        """Add a mesh.

        Parameters
        ----------
        name
            Its name in the scene.
        mesh
            A mesh file; an object with `vertices` and `faces`, such as a `trimesh.Trimesh`; or `(vertices, faces)`: arrays `(V, 3)` in
            metres and `(F, 3)` of indices.
        pose
            The pose of its frame in the world.

        Raises
        ------
        ArrayError
            If `vertices` or `faces` are no such arrays.
        """
        if isinstance(mesh, str | os.PathLike):
            self._object(name, pose, shape="mesh", mesh=_absolute(mesh))
            return
        if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
            mesh = (mesh.vertices, mesh.faces)
        if not (isinstance(mesh, tuple) and len(mesh) == 2):
            raise ArgumentError(f"a {type(mesh).__name__} is not a mesh\n  write: a file, a trimesh.Trimesh, or (vertices, faces)")
        found = _Mesh(*mesh)
        self._object(name, pose, shape="mesh", mesh=found)

    def add(self, table: str, name: str | None = None, /, **keys: Any) -> None:
        """Add a table of the cell file, such as `add("region", "zone", shape="box", size=[1, 1, 1], warning=0.3)`.

        Parameters
        ----------
        table, name
            The table is `[TABLE.NAME]`; one of this name is replaced. Without a name it is `[TABLE]`, such as `[monitor]`.
        keys
            Its keys: numbers in metres, radians and seconds, text, true and false, lists, dicts, paths.
        """
        for word, what in ((table, "table"), ("" if name is None else name, "name")):
            # Whoever calls may not check types.
            if type(word) is not str or not word and (what == "table" or name is not None):
                raise ArgumentError(f"a {what} is text, and not {word!r}\n  write: add(\"object\", \"name\", …)")
        self._tables.setdefault(table, {})[name or ""] = _own(keys)

    def move(self, name: str, pose: PoseLike) -> None:
        """Move an object, or the base of a robot, to a pose in the world."""
        objects, robots = self._tables.get("object", {}), self._tables.get("robot", {})
        if name in objects:
            given = objects[name]
            if "from" in given:
                raise ArgumentError(f'"{name}" lies between two points\n  write: add("object", "{name}", …) with other points')
            placed = {key: value for key, value in given.items() if key not in ("at", "rpy", "quaternion")}
            objects[name] = placed | _pose(pose)
        elif name in robots:
            robots[name]["base"] = _pose(pose)
        else:
            self._unknown(name)

    def remove(self, name: str) -> None:
        """Remove what has this name: an object or a robot, otherwise another table."""
        self._robots.pop(name, None)
        for table in ("object", "robot", *self._tables):
            if self._tables.get(table, {}).pop(name, None) is not None:
                return
        self._unknown(name)

    def cell(self) -> Cell:
        """Return the scene as a cell.

        It is not changed by what is added later. Its file is a temporary one, which exists as long as the cell does: for pickles that
        are to last, and for other machines, `save` it.

        Raises
        ------
        FileError
            What is wrong with a table, and what to write instead.
        """
        folder = Path(tempfile.mkdtemp(prefix="elbowroom-")).resolve()
        path = folder / "scene.toml"
        try:
            path.write_text(self._text(path), encoding="utf-8")
            cell = _loaded(path)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        weakref.finalize(cell, shutil.rmtree, folder, ignore_errors=True)
        return cell

    def save(self, file: str | os.PathLike[str]) -> Cell:
        """Write the cell file, with a file beside it for each mesh that has none and a folder for each robot of another package.

        A file that is there is replaced only by one that can be loaded. Files of meshes are named after their contents. Returns the cell.

        Raises
        ------
        FileError
            If the file cannot be written, or what is wrong with a table.
        """
        path = _absolute(file)
        # In the same folder, because other files are relative to it.
        new = path.with_name(f".{path.name}.new") if path.exists() else path
        try:
            new.write_text(self._text(path), encoding="utf-8")
            if new != path:
                _loaded(new)
                new.replace(path)
        except OSError as error:
            raise unwritable(path, error) from error
        finally:
            if new != path:
                new.unlink(missing_ok=True)
        return Cell.load(path)

    def page(self) -> str:
        """Return the scene as an HTML page that needs no network."""
        return self.cell().page()

    def _repr_html_(self) -> str:
        return self.cell()._repr_html_()

    def __repr__(self) -> str:
        """Say how much the scene has."""
        robots, objects = (len(self._tables.get(table, {})) for table in ("robot", "object"))
        return f"Scene({self.name!r}: {robots} robots, {objects} objects)"

    def _object(self, name: str, pose: PoseLike | None, **keys: Any) -> None:
        self.add("object", name, **keys | ({} if pose is None else _pose(pose)))

    def _unknown(self, name: str) -> None:
        known = [*self._tables.get("object", {}), *self._tables.get("robot", {})]
        raise ArgumentError(f'the scene has no "{name}"\n  write: {", ".join(known) or "a scene with an object"}')

    def _text(self, path: Path) -> str:
        """Return the cell file, and write its meshes."""
        writer = _Writer(path)
        lines = ["version = 1", f"name = {_text(self.name)}", 'units = { length = "m", angle = "rad" }']
        lines += [f"{_key(key)} = {writer.value(value, key)}" for key, value in self._keys.items()]
        for table, named in self._tables.items():
            for name, keys in named.items():
                lines += ["", f"[{table}.{_key(name)}]" if name else f"[{table}]"]
                lines += [f"{_key(key)} = {writer.value(value, name)}" for key, value in keys.items()]
        lines.append("")
        return "\n".join(lines)


def _loaded(path: Path) -> Cell:
    """Load a file that does not stay; an error has the text of its line instead of the number."""
    try:
        return Cell.load(path)
    except FileError as error:
        if error.file != str(path) or error.line is None:
            raise
        line = path.read_text(encoding="utf-8").split("\n")[error.line - 1]
        text = f"scene, `{line}`: {error.message}" + (f"\n  write: {error.hint}" if error.hint else "")
        raise FileError(text, "scene", None, error.message, error.hint) from None


class _Mesh:
    """Triangles in memory."""

    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike) -> None:
        points, corners = _array("vertices", vertices, np.float64), _array("faces", faces, np.int64)
        if not np.isfinite(points).all():
            raise ArrayError("`vertices` has values that are not finite\n  write: finite numbers, metres")
        if corners.size and not (0 <= corners.min() and corners.max() < len(points)):
            raise ArrayError(f"`faces` has indices from {corners.min()} to {corners.max()}\n  write: 0 to {len(points) - 1}")
        #: An OBJ file.
        self.obj = obj(points, corners)


def _array(name: str, values: npt.ArrayLike, kind: type) -> npt.NDArray[Any]:
    try:
        found = np.asarray(values)
    except ValueError as error:
        raise ArrayError(f"`{name}`: {error}\n  write: an array of shape (N, 3)") from error
    number = np.integer if kind is np.int64 else np.number
    if found.ndim != 2 or found.shape[1] != 3 or not np.issubdtype(found.dtype, number) or np.iscomplexobj(found):
        what = "whole numbers" if kind is np.int64 else "numbers"
        raise ArrayError(f"`{name}` has the shape {found.shape} and the type {found.dtype}\n  write: {what} of shape (N, 3)")
    return found.astype(kind)


def _numbers(name: str, values: npt.ArrayLike, count: int) -> list[float]:
    try:
        found = real(values)
    except (TypeError, ValueError) as error:
        raise ArrayError(f"`{name}`: {error}\n  write: {count} numbers, metres") from error
    if found.shape != (count,) or not np.isfinite(found).all():
        raise ArrayError(f"`{name}` is {values!r}\n  write: {count} finite numbers, metres")
    numbers: list[float] = found.tolist()
    return numbers


def _pose(pose: PoseLike) -> dict[str, Any]:
    """Return the keys of a pose."""
    x, y, z, *quaternion = poses.row(np.array(poses.matrix(pose))).tolist()
    return {"at": [x, y, z], "quaternion": quaternion}


def _absolute(file: str | os.PathLike[str]) -> Path:
    """Return a file from the root of the file system; links are not followed."""
    return Path.cwd() / file


def _own(value: Any) -> Any:
    """Return a copy of the keys of a table, with files from the root of the file system."""
    if isinstance(value, os.PathLike):
        return _absolute(value)
    if isinstance(value, Mapping):
        return {key: _own(of) for key, of in value.items()}
    if isinstance(value, list | tuple):
        return [_own(of) for of in value]
    return value.copy() if isinstance(value, np.ndarray) else value


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(text: str) -> str:
    # Strings of JSON are strings of TOML, but for the character DEL.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


class _Writer:
    """Values of TOML for a cell file; other files are relative to it."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def value(self, value: Any, name: str) -> str:
        """Return a value of a table of this name."""
        if isinstance(value, _Mesh):
            return _text(self._mesh(value, name))
        if isinstance(value, os.PathLike):
            return _text(self._relative(Path(value)))
        if isinstance(value, str):
            return _text(value)
        if isinstance(value, bool | np.bool_):
            return "true" if value else "false"
        if isinstance(value, int | np.integer):
            return str(int(value))
        if isinstance(value, float | np.floating):
            return repr(float(value))
        if isinstance(value, Mapping):
            return "{ " + ", ".join(f"{_key(key)} = {self.value(of, name)}" for key, of in value.items()) + " }"
        if isinstance(value, Sequence | np.ndarray):
            return "[" + ", ".join(self.value(of, name) for of in value) + "]"
        raise ArgumentError(f"a {type(value).__name__} has no place in a cell file\n  write: numbers, text, lists or dicts")

    def _mesh(self, mesh: _Mesh, name: str) -> str:
        # Named after its contents, so it replaces no other mesh. Names of objects may be longer than those of files.
        readable = re.sub(r"[^A-Za-z0-9_-]", "_", name)[:64]
        file = self._path.with_name(f"{self._path.stem}.{readable}.{hashlib.sha256(mesh.obj).hexdigest()[:12]}.obj")
        file.write_bytes(mesh.obj)
        return file.name

    def _relative(self, file: Path) -> str:
        folder = temporary_folder(file) or temporary_folder(file.with_name("robot.urdf"))
        if folder is not None and not self._path.is_relative_to(folder):
            # That folder does not last as long as the cell file.
            kept = self._path.with_name(f"{self._path.stem}.{folder.name.removeprefix('elbowroom-')}")
            shutil.copytree(folder, kept, dirs_exist_ok=True)
            file = kept / file.name
        if ".." in file.parts:  # Where a link leads cannot be said from its name.
            return file.as_posix()
        try:
            return Path(os.path.relpath(file, self._path.parent)).as_posix()
        except ValueError:  # On another drive.
            return file.as_posix()
