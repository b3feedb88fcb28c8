"""Scenes put together in Python."""

from __future__ import annotations

import gc
import os
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import elbowroom as er
from conftest import ROOT

ARM = {"a": 0.4, "min": -2.9, "max": 2.9, "speed": 1.5}
CUBE = (
    np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)]),
    np.array(
        [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    ),
)


def an_arm() -> er.Scene:
    scene = er.Scene("bench")
    link = {"capsule": {"from": [-0.4, 0, 0], "to": [0, 0, 0], "radius": 0.04}}
    scene.add("robot", "arm", dh=[ARM, ARM], links=[[], link])
    return scene


def distances(scene: er.Scene, q: list[list[float]]) -> list[float]:
    found: list[float] = er.Checker(scene.cell()).distance(np.array(q, dtype=float)).tolist()
    return found


def test_every_solid_is_where_it_was_put() -> None:
    q = [[0.0, 0.0]]
    up = ([0.6, 0.0, 0.5], [0.0, 0.0, 0.0, 1.0])
    scene = an_arm()
    scene.add_box("solid", [0.2, 0.2, 0.2], up)
    assert distances(scene, q) == pytest.approx([0.36])
    scene.add_sphere("solid", 0.1, [0.6, 0.0, 0.5])
    assert distances(scene, q) == pytest.approx([0.36])
    scene.add_cylinder("solid", 0.3, 0.4, up)
    assert distances(scene, q) == pytest.approx([0.26])
    scene.add_capsule("solid", 0.1, 0.4, up)
    assert distances(scene, q) == pytest.approx([0.16])
    scene.add_mesh("solid", CUBE, up)
    assert distances(scene, q) == pytest.approx([0.36])
    scene.move("solid", ([0.6, 0.0, -0.5], [0.0, 0.0, 1.0, 0.0]))
    assert distances(scene, q) == pytest.approx([0.36])
    scene.remove("solid")
    scene.add_floor(height_m=-0.3)
    assert distances(scene, q) == pytest.approx([0.26])
    scene.move("floor", ([0.0, 0.0, -0.2], [0.0, 0.0, 0.0, 1.0]))
    assert distances(scene, q) == pytest.approx([0.16])
    assert repr(scene) == "Scene('bench': 1 robots, 1 objects)" and "floor" in scene.page()


def test_a_mesh_in_memory_is_that_of_a_file(tmp_path: Path) -> None:
    vertices, faces = CUBE[0] / 3.0, CUBE[1]
    file = tmp_path / "cube.obj"
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
    file.write_text(text + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces.tolist()))
    at = ([0.5, 0.2, 0.1], [0.1, 0.2, 0.3, 0.9])
    q = np.random.default_rng(1).uniform(-2.9, 2.9, (200, 2))
    answers = []
    for mesh in (file, str(file), (vertices, faces), SimpleNamespace(vertices=vertices, faces=faces)):
        scene = an_arm()
        scene.add_mesh("cube", mesh, at)
        answers.append(er.Checker(scene.cell(), between="arm,cube").distance(q))
    assert (answers[0] > 0.01).any()
    for other in answers[1:]:
        assert (other == answers[0]).all()


def test_a_mesh_may_have_a_name_that_is_longer_than_those_of_files() -> None:
    scene = an_arm()
    scene.add_mesh("part" * 200, CUBE)
    assert list(scene.cell().objects) == ["part" * 200]


def test_a_saved_scene_is_a_cell_file_that_moves_with_its_meshes(tmp_path: Path, rx60b: Path) -> None:
    scene = er.Scene("two arms")
    robot = er.Robot.load(rx60b, rx60b.with_suffix(".srdf"))
    scene.add_robot("left", robot, start=[0.1, 0, 1.2, 0, 0, 0])
    scene.add_robot("right arm", rx60b, ([1.5, 0, 0], [0, 0, 1, 0]))
    at = ([0.7, 0, 0.3], [0, 0, 0, 1])
    scene.add_mesh("part", CUBE, at)
    scene.add_mesh("Part", CUBE, ([0.7, 0.7, 0.3], [0, 0, 0, 1]))
    scene.add("region", "zone", shape="box", base=[0.7, 0, 0.3], size=[0.5, 0.5, 0.5], warning=0.2)
    cell = scene.save(tmp_path / "cell.toml")
    assert cell.name == "two arms" and cell.robots == ["left", "right arm"] and er.Monitor(cell).regions == ["zone"]
    names = sorted(re.sub("[0-9a-f]{12}", "…", file.name) for file in tmp_path.iterdir())
    assert names == ["cell.Part.….obj", "cell.part.….obj", "cell.toml"]
    again = pickle.loads(pickle.dumps(cell))
    q = np.random.default_rng(2).uniform(-1.5, 1.5, (100, 12))
    expected = er.Checker(scene.cell()).distance(q)
    assert (er.Checker(again).distance(q) == expected).all()
    # Another folder at the same depth: the model is found by the same relative path.
    other = tmp_path.parent / f"{tmp_path.name}_moved"
    tmp_path.rename(other)
    assert (er.Checker(er.Cell.load(other / "cell.toml")).distance(q) == expected).all()
    other.rename(tmp_path)


def test_the_file_of_a_cell_that_was_not_saved_exists_as_long_as_the_cell() -> None:
    scene = an_arm()
    scene.add_mesh("part", CUBE, ([0.6, 0, 0.5], [0, 0, 0, 1]))
    cell = scene.cell()
    q = np.zeros((1, 2))
    pickled = pickle.dumps(cell)
    assert (er.Checker(pickle.loads(pickled)).distance(q) == er.Checker(cell).distance(q)).all()
    folder = cell.path.parent
    assert len(list(folder.glob("scene.part.*.obj"))) == 1
    # What is refused later names a file that can be read.
    with pytest.raises(er.FileError) as found:
        er.Planner(cell).plan([0, 0], [9, 9])
    assert Path(found.value.file).is_file()
    del cell
    gc.collect()
    assert not folder.exists()
    with pytest.raises(er.FileError, match="cannot be read"):
        pickle.loads(pickled)


def test_what_has_no_place_in_a_scene_teaches() -> None:
    scene = an_arm()
    words: Any = ["a", 2, 3]
    at = ([0.6, 0, 0], [0, 0, 0, 1])
    refused: tuple[tuple[Callable[[], None], type[er.Error], str], ...] = (
        (lambda: scene.add_box("box", [1, 2]), er.ArrayError, "`size_m`"),
        (lambda: scene.add_box("box", [1, 2, 3j]), er.ArrayError, "complex numbers"),
        (lambda: scene.add_box("box", [1, 2, np.nan]), er.ArrayError, "finite"),
        (lambda: scene.add_box("box", words), er.ArrayError, "`size_m`"),
        (lambda: scene.add_box("", [1, 2, 3]), er.ArgumentError, "a name is text"),
        (lambda: scene.add_box("box", [1, 2, 3], np.eye(3)), er.ArrayError, "`pose`"),
        (lambda: scene.add_mesh("mesh", 5), er.ArgumentError, "not a mesh"),
        (lambda: scene.add_mesh("mesh", (CUBE[0], CUBE[1] + 1)), er.ArrayError, "indices from 1 to 8"),
        (lambda: scene.add_mesh("mesh", (CUBE[0] * np.inf, CUBE[1])), er.ArrayError, "not finite"),
        (lambda: scene.add_mesh("mesh", (CUBE[0][:, :2], CUBE[1])), er.ArrayError, "`vertices`"),
        (lambda: scene.add_mesh("mesh", (CUBE[0], CUBE[1] * 0.5)), er.ArrayError, "whole numbers"),
        (lambda: scene.move("nothing", at), er.ArgumentError, 'no "nothing"\n  write: arm'),
        (lambda: scene.remove("nothing"), er.ArgumentError, 'no "nothing"'),
    )
    for add, error, text in refused:
        with pytest.raises(error, match=text):
            add()
    scene.add_sphere("ball", -1.0, [0, 0, 0])
    with pytest.raises(er.FileError, match="scene, `radius = -1.0`") as found:
        scene.cell()
    assert found.value.hint and found.value.line is None
    scene.remove("ball")
    scene.add("object", "thing", shape="box", size=[1, 1, 1], colour=object())
    with pytest.raises(er.ArgumentError, match="a object has no place"):
        scene.cell()
    scene.add("object", "thing", shape="box", size=[1, 1, 1], colour="red")
    with pytest.raises(er.FileError, match="colour"):
        scene.cell()


def test_saving_replaces_no_file_of_others_and_no_good_file(tmp_path: Path) -> None:
    def cube(scale: float, file: Path) -> None:
        vertices, faces = (scale * CUBE[0]).tolist(), (CUBE[1] + 1).tolist()
        file.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))

    cube(3.0, tmp_path / "bench.part.obj")
    before = (tmp_path / "bench.part.obj").read_bytes()
    scene = an_arm()
    scene.add_mesh("mine", tmp_path / "bench.part.obj", ([0, 2, 0], [0, 0, 0, 1]))
    for name in ("part", "PART", "part_2", "part 2"):
        scene.add_mesh(name, (CUBE[0], CUBE[1]), ([2, 0, 0], [0, 0, 0, 1]))
    first = scene.save(tmp_path / "bench.toml")
    q = np.zeros((1, 2))
    assert (tmp_path / "bench.part.obj").read_bytes() == before
    assert er.Checker(first, between="arm,mine").distance(q)[0] == pytest.approx(1.663, abs=1e-3)
    good = (tmp_path / "bench.toml").read_bytes()
    scene.add_sphere("ball", -1.0, [0, 0, 0])
    with pytest.raises(er.FileError, match="scene, `radius = -1.0`"):
        scene.save(tmp_path / "bench.toml")
    assert (tmp_path / "bench.toml").read_bytes() == good and not list(tmp_path.glob(".*"))
    scene.remove("ball")
    scene.move("part", ([5, 0, 0], [0, 0, 0, 1]))
    assert scene.save(tmp_path / "bench.toml").path == tmp_path / "bench.toml"
    assert (tmp_path / "bench.toml").read_bytes() != good
    with pytest.raises(er.FileError, match="cannot be written"):
        scene.save(tmp_path / "nowhere" / "bench.toml")


def test_files_are_those_of_the_folder_in_which_they_were_named(tmp_path: Path, rx60b: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ns16 = ROOT / "examples/models/ns16"
    for folder, model in (("one", rx60b.parent), ("two", ns16)):
        (tmp_path / folder).mkdir()
        os.symlink(model, tmp_path / folder / "arm")
    monkeypatch.chdir(tmp_path / "one")
    robot = er.Robot.load("arm/rx60b.urdf")
    scene = er.Scene()
    scene.add_robot("arm", "arm/rx60b.urdf", srdf="arm/rx60b.srdf")
    cell = scene.save("cell.toml")
    monkeypatch.chdir(tmp_path / "two")
    copied = pickle.loads(pickle.dumps(robot))
    assert copied.name == robot.name and copied.links == robot.links
    other = er.Scene()
    other.add_robot("arm", robot)
    for again in (other.cell(), scene.cell(), pickle.loads(pickle.dumps(cell))):
        assert er.Checker(again).joints == [f"arm.{joint}" for joint in robot.joints]


def test_tables_without_a_name_and_keys_outside_of_tables() -> None:
    scene = er.Scene("laws", tick_ms=4)
    scene.add("robot", "arm", dh=[ARM], links=[{"sphere": {"radius": 0.1}}])
    scene.add("monitor", stopping_distance=True, direction_aware=True)
    scene.add("region", "zone", shape="box", base=[2, 0, 0], size=[1, 1, 1], warning=0.2)
    scene.add("object", "pipe", shape="cylinder", radius=0.1, **{"from": [3, 0, 0], "to": [3, 0, 1]})
    cell = scene.cell()
    assert er.Monitor(cell).regions == ["zone"] and cell.run().trace("arm").times_s[1:2].tolist() in ([], [0.004])
    scene.remove("zone")
    assert er.Monitor(scene.cell()).regions == []
    with pytest.raises(er.ArgumentError, match="between two points"):
        scene.move("pipe", ([0, 0, 0], [0, 0, 0, 1]))
    # What is changed after it was added does not change the scene.
    size = [1.0, 1.0, 1.0]
    scene.add("object", "box", shape="box", size=size, at=[0, 0, 9])
    size[0] = -5.0
    scene.cell()


def test_names_and_text_are_written_as_they_are() -> None:
    scene = er.Scene('a "name"\twith \\ and ü')
    scene.add("robot", "arm", dh=[ARM], links=[{"sphere": {"radius": np.float64(0.1)}}], states={"home": (0.5,)})
    scene.add_box("a box", np.array([1, 2, 3]), ([3, 0, 0], [0, 0, 0, 1]))
    cell = scene.cell()
    assert cell.name == 'a "name"\twith \\ and ü' and er.Checker(cell, between="arm,a box").distance(np.zeros((1, 1)))[0] > 1.0
