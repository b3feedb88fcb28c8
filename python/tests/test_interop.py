"""Models and scenes of other packages: trimesh, yourdfpy, pinocchio, rerun."""

from __future__ import annotations

import importlib
import pickle
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import elbowroom as er
from conftest import ROOT

NS16 = ROOT / "examples/models/ns16/ns16.urdf"

#: A robot with every kind of joint and of solid, in a tree; a joint follows another one.
MIXED = """<robot name="mixed">
  <link name="floor"><collision><geometry><box size="0.3 0.3 0.1"/></geometry></collision></link>
  <link name="tower"><collision><origin xyz="0 0 0.2" rpy="0.3 0.2 0.1"/><geometry><cylinder radius="0.05" length="0.4"/></geometry></collision></link>
  <link name="sledge"><collision><geometry><sphere radius="0.08"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.04 0.04"/></geometry></collision></link>
  <link name="hand"/>
  <link name="left"><collision><geometry><box size="0.02 0.01 0.06"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.02 0.01 0.06"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="floor"/><child link="tower"/><origin xyz="0 0 0.06"/><axis xyz="0 0 1"/>
    <limit effort="10" velocity="2"/></joint>
  <joint name="lift" type="prismatic"><parent link="tower"/><child link="sledge"/><origin xyz="0.15 0 0.1" rpy="0 0.4 0"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-0.1" upper="0.3" effort="10" velocity="0.5"/></joint>
  <joint name="swing" type="revolute"><parent link="sledge"/><child link="arm"/><origin xyz="0.1 0 0" rpy="0.1 1.5707963267948966 0.7"/><axis xyz="0.36 0.48 0.8"/>
    <limit lower="-2" upper="1" effort="10" velocity="1.5"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.22 0 0" rpy="0 0 0.5"/></joint>
  <joint name="finger" type="prismatic"><parent link="hand"/><child link="left"/><origin xyz="0.04 0.01 0"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/></joint>
  <joint name="thumb" type="prismatic"><parent link="hand"/><child link="right"/><origin xyz="0.04 -0.01 0"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/><mimic joint="finger" multiplier="0.5" offset="0.003"/></joint>
</robot>
"""


@pytest.fixture
def mixed(tmp_path: Path) -> Path:
    file = tmp_path / "mixed.urdf"
    file.write_text(MIXED)
    return file


def states(robot: er.Robot, count: int) -> Any:
    lower, upper = np.clip(robot.limits, -3.0, 3.0).T
    return np.random.default_rng(5).uniform(lower, upper, (count, robot.dof))


def check_same(robot: er.Robot, other: er.Robot, names: Mapping[str, str], limits: bool = True) -> None:
    """Links named so are at the same places, with the joints in any order."""
    assert sorted(robot.joints) == sorted(other.joints)
    order = [robot.joints.index(joint) for joint in other.joints]
    q = states(robot, 50)
    for name, other_name in names.items():
        assert np.abs(robot.fk(q, link=name) - other.fk(q[:, order].copy(), link=other_name)).max() < 1e-12, name
    if limits:
        assert np.allclose(robot.limits[order], other.limits, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize("robot", ["mixed", "ns16"])
def test_a_model_of_yourdfpy_is_the_robot(robot: str, mixed: Path) -> None:
    yourdfpy = pytest.importorskip("yourdfpy")
    file = mixed if robot == "mixed" else NS16
    expected = er.Robot.load(file)
    found = er.Robot.of(yourdfpy.URDF.load(str(file), load_meshes=False, build_scene_graph=False))
    assert found.links == expected.links and found.joints == expected.joints and found.name == expected.name
    check_same(expected, found, {link: link for link in expected.links})
    q = states(expected, 200)
    # It writes turns from matrices.
    assert np.allclose(er.Checker(found).distance(q), er.Checker(expected).distance(q), rtol=0.0, atol=1e-12)


def test_a_model_of_pinocchio_is_the_robot(mixed: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(mixed), mimic=True)
    geometry = pinocchio.buildGeomFromUrdf(model, str(mixed), pinocchio.GeometryType.COLLISION)
    expected = er.Robot.load(mixed)
    found = er.Robot.of(model, geometry)
    assert set(found.links) == set(expected.links) and found.tip == expected.tip
    # One joint turns without end.
    check_same(expected, found, {link: link for link in expected.links}, limits=False)
    of = [found.limits[found.joints.index(name)] for name in ("lift", "swing", "finger")]
    assert np.allclose(of, [[-0.1, 0.3], [-2.0, 1.0], [0.0, 0.04]], rtol=1e-15, atol=0.0)
    # The solids are where those of the file are.
    q = states(expected, 200)
    order = [expected.joints.index(joint) for joint in found.joints]
    distances = er.Checker(found).witness(q[:, order].copy()).distance_m
    assert np.allclose(distances, er.Checker(expected).distance(q), atol=1e-9)


def test_distances_are_those_of_coal() -> None:
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(NS16))
    geometry = pinocchio.buildGeomFromUrdf(model, str(NS16), pinocchio.GeometryType.COLLISION, package_dirs=[str(NS16.parent)])
    geometry.addAllCollisionPairs()
    solids = geometry.geometryObjects
    for pair in list(geometry.collisionPairs):
        a, b = solids[pair.first].parentJoint, solids[pair.second].parentJoint
        # Neighbours touch. The third pair is not compared either, so that it is left out here too.
        if a == b or model.parents[a] == b or model.parents[b] == a or {a, b} == {1, 3}:
            geometry.removeCollisionPair(pair)
    robot = er.Robot.of(model, geometry)
    q = states(robot, 60)
    data, of_geometry = model.createData(), geometry.createData()
    expected = []
    for row in q:
        pinocchio.computeDistances(model, data, geometry, of_geometry, row)
        expected.append(min(result.min_distance for result in of_geometry.distanceResults))
    found = er.Checker(robot).distance(q)
    free = np.array(expected) > 0.0
    assert free.sum() > 20 and (~free).sum() > 0 and ((found > 0.0) == free).all()
    assert np.abs(found - expected)[free].max() < 1e-6


def test_a_robot_of_another_package_has_its_files_while_it_lives(mixed: Path, tmp_path: Path) -> None:
    yourdfpy = pytest.importorskip("yourdfpy")
    robot = er.Robot.of(yourdfpy.URDF.load(str(mixed), load_meshes=False, build_scene_graph=False))
    copied = pickle.loads(pickle.dumps(robot))
    assert copied.links == robot.links and robot.page().startswith("<!DOCTYPE html>")
    folder = Path(robot.__reduce__()[1][0][0]).parent
    scene = er.Scene()
    scene.add_robot("arm", robot)
    del robot
    # A scene needs it.
    assert scene.cell().robots == ["arm"] and folder.is_dir()
    del scene
    assert not folder.exists()


def three_joints() -> Any:
    """A model of pinocchio of three joints at one place, and its module."""
    pinocchio = pytest.importorskip("pinocchio")
    model, joint = pinocchio.Model(), 0
    limits = (np.ones(1), np.ones(1), -np.ones(1), np.ones(1))
    for name, kind in (("a", pinocchio.JointModelRX), ("b", pinocchio.JointModelRY), ("c", pinocchio.JointModelRZ)):
        joint = model.addJoint(joint, kind(), pinocchio.SE3.Identity(), name, *limits)
    return pinocchio, model


def geometry_of(pinocchio: Any, solids: list[tuple[str, int, Any, float]], pairs: list[tuple[int, int]]) -> Any:
    """Solids with the heights at which they are in the frame of a joint, and the pairs that are compared."""
    geometry = pinocchio.GeometryModel()
    for name, joint, shape, height in solids:
        geometry.addGeometryObject(pinocchio.GeometryObject(name, joint, pinocchio.SE3(np.eye(3), np.array([0.0, 0.0, height])), shape))
    for a, b in pairs:
        geometry.addCollisionPair(pinocchio.CollisionPair(a, b))
    return geometry


def test_pairs_of_pinocchio_are_tested_or_refused() -> None:
    pinocchio, model = three_joints()
    coal = pytest.importorskip("coal")
    base, far, near = ("base", 0, coal.Box(0.1, 0.1, 0.1), 0.0), ("far", 3, coal.Sphere(0.05), 1.4), ("near", 3, coal.Sphere(0.5), 0.0)
    still = np.zeros((1, 3))
    alone = er.Checker(er.Robot.of(model, geometry_of(pinocchio, [base, far], [(0, 1)])))
    assert alone.distance(still)[0] == pytest.approx(1.3)
    # Solids of one link of which some are compared and others not.
    with pytest.raises(er.ArgumentError, match="are compared and others not"):
        er.Robot.of(model, geometry_of(pinocchio, [base, far, near], [(0, 1)]))
    # One that is switched off counts as not there.
    geometry = geometry_of(pinocchio, [base, far, near], [(0, 1), (0, 2)])
    assert er.Checker(er.Robot.of(model, geometry)).collides(still)[0]
    geometry.geometryObjects[2].disableCollision = True
    assert er.Checker(er.Robot.of(model, geometry)).distance(still)[0] == pytest.approx(1.3)
    # Neighbours, and solids of one joint, are no pairs.
    for joints in ((0, 1), (1, 2), (2, 2)):
        solids = [(f"s{k}", joint, coal.Sphere(0.1), 0.0) for k, joint in enumerate(joints)]
        with pytest.raises(er.ArgumentError, match="at most one joint is between them"):
            er.Robot.of(model, geometry_of(pinocchio, solids, [(0, 1)]))
    box = coal.Box(0.1, 0.1, 0.1)
    box.setSweptSphereRadius(0.2)
    with pytest.raises(er.ArgumentError, match="swept sphere"):
        er.Robot.of(model, geometry_of(pinocchio, [("soft", 1, box, 0.0)], []))
    with pytest.raises(er.ArgumentError, match="is of joint 3"):
        er.Robot.of(pinocchio.Model(), geometry_of(pinocchio, [far], []))
    with pytest.raises(er.ArgumentError, match=r"a .*Model with geometry of int is not a robot"):
        er.Robot.of(model, 5)


@pytest.mark.parametrize(("lower", "upper"), [(-1.0, np.inf), (-np.inf, 1.0), (1.0, -1.0), (np.nan, 1.0)])
def test_limits_of_pinocchio_are_two_or_none(lower: float, upper: float) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.Model()
    model.addJoint(0, pinocchio.JointModelRX(), pinocchio.SE3.Identity(), "j", np.ones(1), np.ones(1), np.array([lower]), np.array([upper]))
    with pytest.raises(er.ArgumentError, match='joint "j" has the limits'):
        er.Robot.of(model)
    # By default there are none.
    free = pinocchio.Model()
    free.addJoint(0, pinocchio.JointModelRX(), pinocchio.SE3.Identity(), "j")
    assert np.isinf(er.Robot.of(free).limits).all()


def test_a_wrapper_of_pinocchio_has_model_and_solids(mixed: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    wrapper = pinocchio.RobotWrapper.BuildFromURDF(str(mixed), [str(mixed.parent)])
    assert set(er.Robot.of(wrapper).meshes("collision")) == {"floor", "tower", "sledge", "arm", "left", "right"}


def test_a_saved_scene_keeps_the_robot_of_another_package(tmp_path: Path) -> None:
    pinocchio, model = three_joints()
    coal = pytest.importorskip("coal")
    scene = er.Scene("bench")
    scene.add_robot("arm", er.Robot.of(model, geometry_of(pinocchio, [("far", 3, coal.Sphere(0.05), 1.4)], [])))
    (tmp_path / "there").mkdir()
    distance = er.Checker(scene.save(tmp_path / "there/bench.toml")).distance
    del scene
    shutil.move(tmp_path / "there", tmp_path / "elsewhere")
    again = er.Cell.load(tmp_path / "elsewhere/bench.toml")
    assert again.robots == ["arm"] and (er.Checker(again).distance(np.zeros((1, 3))) == distance(np.zeros((1, 3)))).all()


def test_what_is_no_robot_teaches() -> None:
    for wrong in (5, "arm.urdf", object()):
        with pytest.raises(er.ArgumentError, match=r"is not a robot\n  write: a yourdfpy.URDF"):
            er.Robot.of(wrong)
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(NS16), pinocchio.JointModelFreeFlyer())
    with pytest.raises(er.ArgumentError, match='joint "root_joint" is a JointModelFreeFlyer'):
        er.Robot.of(model)


def test_meshes_are_the_solids(mixed: Path) -> None:
    robot = er.Robot.load(mixed)
    meshes = robot.meshes("collision")
    assert set(meshes) == {"floor", "tower", "sledge", "arm", "left", "right"}
    box = meshes["arm"]
    assert box.vertices.min(axis=0).tolist() == pytest.approx([0.0, -0.02, -0.02])
    assert box.vertices.max(axis=0).tolist() == pytest.approx([0.2, 0.02, 0.02])
    assert box.faces.shape == (12, 3) and box.faces.dtype == np.uint32 and box.faces.max() == 7
    radius = np.linalg.norm(meshes["sledge"].vertices, axis=1)
    assert np.abs(radius - 0.08).max() < 1e-3
    assert set(robot.meshes()) == set(meshes)
    with pytest.raises(er.ArgumentError, match="`kind`"):
        robot.meshes("hull")
    # A scene takes them.
    scene = er.Scene()
    scene.add_mesh("bar", box, ([0, 0, 1], [0, 0, 0, 1]))
    assert list(scene.cell().objects) == ["bar"]


def test_a_cell_knows_where_its_links_are(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    q = np.random.default_rng(2).uniform(-1, 1, (7, len(cell.joints)))
    poses = cell.fk(q)
    robot = er.Robot.load(NS16)
    # Its base stands elsewhere, always at the same place.
    base = poses["right/link_6"] @ np.linalg.inv(robot.fk(q[:, 6:].copy(), link="link_6"))
    assert np.abs(base - base[0]).max() < 1e-12 and np.abs(base[0] - poses["right/base_link"][0]).max() < 1e-12
    assert np.abs(base[0] - np.eye(4)).max() > 0.1
    assert cell.fk(q[:0])["left/tool0"].shape == (0, 4, 4)
    assert (q[:, cell.columns("right")] == q[:, 6:]).all() and cell.joints_of("right") == robot.joints
    with pytest.raises(er.ArgumentError, match='no robot is called "centre"'):
        cell.columns("centre")
    assert set(cell.meshes()) <= set(poses) | set(cell.objects)
    with pytest.raises(er.ArrayError, match=r"\(N, 12\)"):
        cell.fk(q[:, :6])


def test_scenes_of_trimesh_are_where_the_robot_is(mixed: Path, exchange: Path) -> None:
    pytest.importorskip("trimesh")
    robot = er.Robot.load(mixed)
    q = states(robot, 1)[0]
    scene = robot.to_trimesh(q, "collision")
    assert set(scene.graph.nodes_geometry) == set(robot.meshes("collision"))
    for name in scene.graph.nodes_geometry:
        assert np.abs(scene.graph[name][0] - robot.fk(q[None], link=name)[0]).max() < 1e-12
    solids = [mesh.is_watertight for mesh in scene.geometry.values()]
    assert all(solids) and scene.geometry["arm"].volume == pytest.approx(0.2 * 0.04 * 0.04)
    cell = er.Cell.load(exchange)
    whole = cell.to_trimesh()
    assert set(whole.graph.nodes_geometry) == set(cell.meshes()) and "pallet" in cell.objects
    assert np.abs(whole.graph["pallet"][0] - cell.objects["pallet"]).max() == 0.0
    with pytest.raises(er.ArrayError, match="`q`"):
        robot.to_trimesh([0.0])


def test_what_moves_is_logged_to_rerun(exchange: Path, tmp_path: Path) -> None:
    rerun = pytest.importorskip("rerun")
    cell = er.Cell.load(exchange)
    there = np.array([0.9, 0.9, 0.2, 0.0, 0.8, 0.0])
    motion = er.Trajectory([0.0, 0.5, 1.0], [cell.start[:6], 0.5 * (cell.start[:6] + there), there])
    file = tmp_path / "motion.rrd"
    stream = rerun.RecordingStream("elbowroom")
    stream.save(str(file))
    cell.to_rerun({"left": motion}, stream)
    stream.flush()
    printed = subprocess.run([sys.executable, "-m", "rerun", "rrd", "print", "-vvv", str(file)], capture_output=True, text=True, check=True)
    assert not [name for name in cell.meshes() if f"/cell/{name}" not in printed.stdout]
    # The turn of a link at the end of the motion, by columns.
    turn = cell.fk(np.hstack([there, cell.start[6:]])[None])["left/link_6"][0][:3, :3].T.ravel()
    numbers = [float(value) for value in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", printed.stdout)]
    assert any(np.allclose(numbers[k : k + 5], turn[:5], atol=1e-6) for k in range(len(numbers) - 5))
    run = rerun.RecordingStream("run")
    run.save(str(tmp_path / "run.rrd"))
    cell.run(monitor=False).to_rerun(run)
    run.flush()
    assert (tmp_path / "run.rrd").stat().st_size > file.stat().st_size
    with pytest.raises(er.ArgumentError, match='no robot is called "centre"'):
        cell.to_rerun({"centre": motion}, stream)
    with pytest.raises(er.ArgumentError, match='the motion of "left" is a int'):
        cell.to_rerun({"left": 5}, stream)  # type: ignore[dict-item]
    with pytest.raises(er.ArgumentError, match="the trajectory is of joint_1"):
        cell.to_rerun({"left": er.Trajectory([0.0], [[0.0]])}, stream)


def test_a_package_that_is_missing_is_named(exchange: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original = importlib.import_module

    def missing(name: str, package: str | None = None) -> Any:
        if name in ("trimesh", "rerun"):
            raise ImportError(name)
        return original(name, package)

    monkeypatch.setattr(importlib, "import_module", missing)
    cell = er.Cell.load(exchange)
    with pytest.raises(er.ArgumentError, match=r"needs the package trimesh\n  write: pip install trimesh"):
        cell.to_trimesh()
    with pytest.raises(er.ArgumentError, match="pip install rerun-sdk"):
        cell.to_rerun()
