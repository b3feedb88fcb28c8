"""Paths: free, the same from the same seed, around objects that have moved."""

from __future__ import annotations

import pickle
import signal
import threading
import time
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

import elbowroom as er
from conftest import ROOT

START, GOAL = [1.0, 0.9, 0.2, 0, 0.8, 0], [-1.0, 0.9, 0.2, 0, 0.8, 0]


def free(cell: er.Cell, path: er.Path) -> bool:
    """Whether nothing touches along a path of the first robot of a cell."""
    checker = er.Checker(cell)
    q = np.tile(checker.start, (len(path.q), 1))
    q[:, : len(path.joints)] = path.q
    return not checker.collides(q).any()


def test_a_path_is_free_and_is_the_same_with_the_same_seed(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    planner = er.Planner(cell, "left")
    path = planner.plan(START, np.array(GOAL))
    assert path and path.reason is None and path.robot == planner.robot == "left" and path.joints == planner.joints
    assert (path.q[0] == START).all() and (path.q[-1] == GOAL).all()
    assert path.times_s[0] == 0.0 and (np.diff(path.times_s) > 0).all() and path.duration_s == path.times_s[-1]
    assert free(cell, path)
    # A planner that has answered other requests answers as a new one, and as a copied one.
    assert planner.plan(GOAL, START) and planner.plan(START, [0.5, 0.9, 0.2, 0, 0.8, 0], seed=7)
    for other in (planner, er.Planner(cell, "left"), pickle.loads(pickle.dumps(planner))):
        assert (other.plan(START, GOAL).q == path.q).all()
    slow = planner.plan(START, GOAL, speed=0.5)
    assert slow.duration_s > 1.3 * path.duration_s and (slow.waypoints == path.waypoints).all()
    assert planner.plan(START, GOAL, period_s=0.1).times_s[1] == pytest.approx(0.1)


def test_a_path_leads_around_an_object_that_has_moved() -> None:
    scene = er.Scene()
    arm = {"a": 0.4, "min": -2.9, "max": 2.9, "speed": 1.5}
    link = {"capsule": {"from": [-0.4, 0, 0], "to": [0, 0, 0], "radius": 0.04}}
    scene.add("robot", "arm", dh=[arm, arm], links=[[], link])
    scene.add_sphere("ball", 0.1, [0, 3, 0])
    cell = scene.cell()
    planner = er.Planner(cell)
    straight = planner.plan([-1, 0], [1, 0])
    moved = ([0.7, 0, 0], [0, 0, 0, 1])
    around = planner.plan([-1, 0], [1, 0], objects={"ball": moved})
    scene.move("ball", moved)
    assert straight.cost_rad == pytest.approx(2.0) and around.cost_rad is not None and around.cost_rad > 2.5
    assert free(scene.cell(), around) and not free(scene.cell(), straight)
    # The object is back in its place in the next request, and on the page where it was.
    assert planner.plan([-1, 0], [1, 0]).cost_rad == straight.cost_rad
    assert around.page() != straight.page() and "ball" in around.page()
    # Any mapping will do.
    assert (planner.plan([-1, 0], [1, 0], objects=MappingProxyType({"ball": moved})).q == around.q).all()
    with pytest.raises(er.ArgumentError, match='no object "bal"\n  write: .*ball'):
        planner.plan([-1, 0], [1, 0], objects={"bal": moved})
    with pytest.raises(er.ArgumentError, match="`objects` is a list"):
        planner.plan([-1, 0], [1, 0], objects=["ball"])  # type: ignore[arg-type]


def test_a_region_that_follows_an_object_is_where_the_object_is() -> None:
    def cell(at: list[float]) -> er.Cell:
        scene = er.Scene()
        model = ROOT / "examples/models/ns16/ns16.urdf"
        scene.add_robot("arm", model, srdf=model.with_suffix(".srdf"), start=[1, 0.2, 0.2, 0, 0.8, 0])
        scene.add_box("cart", [0.1, 0.1, 0.1], (at, [0, 0, 0, 1]))
        region = {"shape": "box", "base": [0, 0, -0.4], "size": [0.6, 0.6, 0.8], "warning": 0.1}
        scene.add("region", "zone", **region, follow={"object": "cart"}, guards=["tcp", "arm"])
        return scene.cell()

    far, near = [1.2, 3.0, 1.0], [1.2, 0.0, 1.0]
    q0, q1 = [1, 0.2, 0.2, 0, 0.8, 0], [-1, 0.2, 0.2, 0, 0.8, 0]
    there, expected = er.Planner(cell(far)), er.Planner(cell(near)).plan(q0, q1)
    around = there.plan(q0, q1, objects={"cart": (near, [0, 0, 0, 1])})
    assert expected and (around.q == expected.q).all()
    assert er.Checker(cell(near), between="arm,zone").distance(around.q).min() > 0.0
    back = er.Planner(cell(near)).plan(q0, q1, objects={"cart": (far, [0, 0, 0, 1])})
    assert (back.q == there.plan(q0, q1).q).all() and len(back.waypoints) == 2


def test_a_pose_is_reached_also_on_a_straight_line(rx60b: Path) -> None:
    scene = er.Scene()
    scene.add_robot("arm", rx60b)
    planner, robot = er.Planner(scene.cell()), er.Robot.load(rx60b)
    start = np.array([[0.3, 0.4, 1.2, 0.0, 0.6, 0.0]])
    pose = robot.fk(start)[0]
    pose[:3, 3] += [0.0, 0.15, -0.1]
    for linear in (False, True):
        path = planner.plan(start[0], pose=pose, linear=linear)
        assert path and np.allclose(robot.fk(path.q[-1:])[0], pose, atol=1e-6)
        way = robot.fk(path.q)[:, :3, 3] - robot.fk(start)[0, :3, 3]
        off = np.linalg.norm(np.cross(way, way[-1]), axis=1) / np.linalg.norm(way[-1])
        assert not linear or off.max() < 6e-4


def test_ctrl_c_ends_a_search(exchange: Path) -> None:
    planner = er.Planner(er.Cell.load(exchange), "left")
    planner.plan(START, GOAL)
    # Started in the background, a shell's children ignore the signal.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        sent: list[float] = []

        def interrupt() -> None:
            sent.append(time.monotonic())
            signal.raise_signal(signal.SIGINT)

        threading.Timer(0.5, interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            planner.plan(START, GOAL, optimize=True, time_limit_s=60)
        assert time.monotonic() - sent[0] < 2.0
    finally:
        signal.signal(signal.SIGINT, before)
    assert planner.plan(START, GOAL)


def test_ctrl_c_ends_a_call_that_waits_for_another_thread(exchange: Path) -> None:
    planner = er.Planner(er.Cell.load(exchange), "left")
    expected = planner.plan(START, GOAL)
    took_s: list[float] = []

    def search() -> None:
        begin = time.monotonic()
        assert planner.plan(START, GOAL, optimize=True, time_limit_s=2)
        took_s.append(time.monotonic() - begin)

    searching = threading.Thread(target=search)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        searching.start()
        time.sleep(0.3)
        threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            planner.plan(START, GOAL)
        waited = time.monotonic() - begin
    finally:
        signal.signal(signal.SIGINT, before)
        searching.join()
    # The search of the other thread was not ended.
    assert waited < 1.3 and took_s[0] > 1.9
    assert (planner.plan(START, GOAL).q == expected.q).all()


def test_threads_take_turns(exchange: Path) -> None:
    planner = er.Planner(er.Cell.load(exchange), "left")
    goals = [[angle, 0.9, 0.2, 0, 0.8, 0] for angle in (-1.0, -0.9, 0.9, 1.1)]
    expected = [planner.plan(START, goal) for goal in goals]
    found: dict[int, er.Path] = {}
    threads = [threading.Thread(target=lambda n=n: found.update({n: planner.plan(START, goals[n])})) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((found[n].q == expected[n].q).all() for n in range(4))


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        ({"q0": [0.0] * 5}, er.ArrayError, "`q0` is"),
        ({"q1": [0.0] * 5 + [np.nan]}, er.ArrayError, "`q1` is"),
        ({"q1": "home"}, er.ArrayError, "`q1` is not a row of numbers"),
        ({"q1": None}, er.ArgumentError, "one goal"),
        ({"pose": np.eye(4)}, er.ArgumentError, "one goal"),
        ({"q1": None, "pose": np.eye(3)}, er.ArrayError, "`pose`"),
        ({"q1": [9.0] * 6}, er.FileError, "limit"),
        ({"time_limit_s": -1.0}, er.ArgumentError, "seconds above 0"),
        ({"speed": np.nan}, er.ArgumentError, "`speed`"),
        ({"speed": 1e-9}, er.FileError, "more than 5000000 rows"),
        ({"period_s": 1e-9}, er.FileError, "more than 5000000 rows"),
        ({"period_s": 0.0}, er.ArgumentError, "`period_s`"),
        ({"q1": None, "pose": (0.4, [0, 0, 0, 1])}, er.ArrayError, "place of shape"),
        ({"q1": None, "pose": np.eye(4) + 0j}, er.ArrayError, "complex numbers"),
        ({"linear": True}, er.FileError, "a pose as the goal"),
    ],
)
def test_what_cannot_be_planned_teaches(exchange: Path, change: dict[str, object], error: type, text: str) -> None:
    words = {"q0": START, "q1": GOAL, **change}
    with pytest.raises(error, match=text):
        er.Planner(er.Cell.load(exchange), "left").plan(**words)  # type: ignore[arg-type]


def test_a_planner_that_cannot_be_teaches(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    with pytest.raises(er.FileError, match="nobody"):
        er.Planner(cell, "nobody")
    with pytest.raises(er.FileError, match="name one"):
        er.Planner(cell)
    with pytest.raises(er.ArgumentError, match="rrt-connect"):
        er.Planner(cell, "left", planner="prm")
    for clearance_m in (float("nan"), -1.0):
        with pytest.raises(er.ArgumentError, match="`clearance_m`"):
            er.Planner(cell, "left", clearance_m=clearance_m)


def test_a_planner_of_a_map_takes_free_cells() -> None:
    scene = er.Scene()
    turn, lift = {"alpha": np.pi / 2, "min": -2.9, "max": 2.9, "speed": 1.5}, {"a": 0.4, "min": -1.2, "max": 1.2, "speed": 1.5}
    link = {"capsule": {"from": [-0.4, 0, 0], "to": [0, 0, 0], "radius": 0.04}}
    scene.add("robot", "arm", dh=[turn, lift, lift], links=[[], link, link])
    scene.add_box("post", [0.1, 0.1, 0.6], ([0.6, 0, 0], [0, 0, 0, 1]))
    scene.add("map", "arm", step=0.05)
    cell = scene.cell()
    for planner in ("grid", "rrt-connect"):
        path = er.Planner(cell, planner=planner).plan([-0.8, 0, 0], [0.8, 0, 0])
        assert path and len(path.waypoints) > 2 and free(cell, path), path.reason
    assert cell.map().is_blocked(np.array([[0.0, 0.0, 0.0], [0.8, 0.0, 0.0]])).tolist() == [True, False]
    # The post in the way of the goal, and away from everything.
    grid = er.Planner(cell, planner="grid")
    assert not grid.plan([-0.8, 0, 0], [0.8, 0, 0], objects={"post": ([0.5, 0, 0], np.array([0, 0, 0.7, 0.7]))}).reason
    assert grid.plan([-0.8, 0, 0], [0.8, 0, 0], objects={"post": ([5, 0, 0], [0, 0, 0, 1])}).cost_rad == pytest.approx(1.6, abs=0.1)
