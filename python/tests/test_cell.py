"""Cells: runs, maps, paths."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import elbowroom as er
from conftest import ROOT

MAP_CELL = """
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
[object.ball]
shape = "sphere"
at = [600, 0, 0]
radius = 100
[map.arm]
step = 5
"""


def test_a_run_has_the_summary_of_the_command(command: Path) -> None:
    path = ROOT / "examples/figure12/cell.toml"
    run = er.Cell.load(path).run()
    printed = subprocess.run([command, "run", path, "--json"], capture_output=True, text=True, check=True).stdout
    expected = json.loads(printed)
    # Times of the machine differ.
    for summary in (run.summary, expected):
        summary.pop("tick_ns", None)
    assert run.summary == expected and not run.has_violation
    for repeat in (0, -1, 2**32):
        with pytest.raises(er.ArgumentError, match="`repeat`"):
            er.Cell.load(path).run(repeat=repeat)
    without = er.Cell.load(path).run(monitor=False)
    assert without.has_violation and without.summary != expected


def test_a_map_is_the_file_of_the_command(command: Path, tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(MAP_CELL)
    found = er.Cell.load(cell).map()
    subprocess.run([command, "map", cell, "--out", tmp_path / "map.npy"], check=True, capture_output=True)
    expected = np.load(tmp_path / "map.npy")
    assert (found.to_numpy() == expected.astype(bool)).all()
    assert found.blocked == expected.sum() == found.blocked_by["ball"] > 0
    assert [len(centers) for centers in found.centers] == list(expected.shape)
    with pytest.raises(ValueError, match="read-only"):
        found.to_numpy()[0, 0] = True
    # Every state that touches the ball is in a blocked cell.
    q = np.random.default_rng(1).uniform(-2.9, 2.9, (2000, 2))
    hits = q[er.Checker(er.Cell.load(cell)).collides(q)]
    at = [np.abs(hits[:, [axis]] - found.centers[axis]).argmin(axis=1) for axis in range(2)]
    assert len(hits) > 20 and found.to_numpy()[at[0], at[1]].all()
    # Every cell's centre is answered as the array has it.
    grid = np.stack(np.meshgrid(*found.centers, indexing="ij"), axis=-1).reshape(-1, 2)
    assert (found.is_blocked(grid) == found.to_numpy().ravel()).all()
    assert found.is_blocked(np.array([[3.2, 0.0], [0.0, -3.2]])).all()
    with pytest.raises(er.ArrayError, match="row 0"):
        found.is_blocked(np.array([[np.nan, 0.0]]))
    with pytest.raises(er.ArgumentError, match="misses cells"):
        er.Cell.load(cell).map(model="seeds")
    with pytest.raises(er.ArgumentError, match="`model`"):
        er.Cell.load(cell).map(model="clay")


def test_a_map_follows_objects_that_move(tmp_path: Path) -> None:
    def map_of(at: str) -> er.JointMap:
        cell = tmp_path / "cell.toml"
        cell.write_text(MAP_CELL.replace("at = [600, 0, 0]", at))
        return er.Cell.load(cell).map()

    first = map_of("at = [600, 0, 0]")
    there = ([0.0, 0.55, 0.1], [0, 0, 0, 1])
    second = first.moved({"ball": there})
    assert (second.to_numpy() == map_of("at = [0, 550, 100]").to_numpy()).all()
    assert (second.to_numpy() != first.to_numpy()).any() and second.blocked_by["ball"] == second.blocked
    assert (second.moved({"ball": ([0.6, 0, 0], [0, 0, 0, 1])}).to_numpy() == first.to_numpy()).all()
    # A sphere that a camera sees is as good as an object, until another picture comes.
    seen = first.moved(spheres=np.array([[0.0, 0.55, 0.1, 0.1]]))
    assert (seen.to_numpy() == (first.to_numpy() | second.to_numpy())).all()
    assert (seen.moved({"ball": ([9.0, 0, 0], [0, 0, 0, 1])}).to_numpy() == second.to_numpy()).all()
    assert (seen.moved(spheres=np.empty((0, 4))).to_numpy() == first.to_numpy()).all()
    for wrong in ([[0.0, 0.0, 0.0, -0.1]], [[0.0, 0.0, np.nan, 0.1]], [[0.0, 0.0, 0.1]]):
        with pytest.raises(er.ArrayError, match="`spheres`"):
            first.moved(spheres=np.array(wrong))
    with pytest.raises(er.ArgumentError, match="no object"):
        first.moved({"bal": there})
    copied = pickle.loads(pickle.dumps(first))
    assert (copied.to_numpy() == first.to_numpy()).all() and copied.joints == first.joints
    with pytest.raises(er.ArgumentError, match="a copied map"):
        copied.moved({"ball": there})


def test_a_cell_pickles_and_a_broken_one_teaches(exchange: Path, tmp_path: Path) -> None:
    cell = er.Cell.load(exchange)
    again = pickle.loads(pickle.dumps(cell))
    assert again.robots == cell.robots == ["left", "right"]
    broken = tmp_path / "cell.toml"
    broken.write_text(MAP_CELL.replace("radius = 100", "radius = -100"))
    with pytest.raises(er.FileError) as found:
        er.Cell.load(broken)
    assert found.value.line == 10 and "radius" in found.value.message


def test_a_run_has_the_trace_of_the_command_and_a_report(command: Path, exchange: Path, tmp_path: Path) -> None:
    run = er.Cell.load(exchange).run()
    subprocess.run([command, "run", exchange, "--out", tmp_path], capture_output=True, check=True)
    rows = [line.split(",") for line in (tmp_path / "trace.csv").read_text().splitlines()]
    for robot in er.Cell.load(exchange).robots:
        trace = run.trace(robot)
        expected = [row for row in rows[1:] if row[rows[0].index("robot")] == robot]
        assert len(expected) == len(trace.times_s) == len(trace.q) > 100 and trace.q.shape[1] == len(trace.joints)
        column = rows[0].index("override")
        assert np.abs(trace.speed_override - [float(row[column]) for row in expected]).max() < 1e-6
    page = run.report(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page and page.startswith("<!DOCTYPE html>")
    assert "<iframe" in run._repr_html_() and 'srcdoc="&lt;!DOCTYPE' in run._repr_html_()
    with pytest.raises(er.ArgumentError, match="the cell has 2 robots"):
        run.trace()
    with pytest.raises(er.ArgumentError, match='no robot is called "middle"'):
        run.trace("middle")
