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
    with pytest.raises(er.ArgumentError, match="misses cells"):
        er.Cell.load(cell).map(model="seeds")
    with pytest.raises(er.ArgumentError, match="`model`"):
        er.Cell.load(cell).map(model="clay")


def test_a_path_is_free_and_is_the_same_with_the_same_seed(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    q0, q1 = [1.0, 0.9, 0.2, 0, 0.8, 0], [-1.0, 0.9, 0.2, 0, 0.8, 0]
    path = er.plan(cell, "left", q0, np.array(q1))
    assert path and path.reason is None and path.robot == "left" and len(path.joints) == 6
    assert (path.q[0] == q0).all() and (path.q[-1] == q1).all()
    assert path.times_s[0] == 0.0 and (np.diff(path.times_s) > 0).all() and path.duration_s == path.times_s[-1]
    checker = er.Checker(cell)
    q = np.tile(checker.start, (len(path.q), 1))
    q[:, :6] = path.q
    assert not checker.collides(q).any()
    assert (er.plan(cell, "left", q0, q1).q == path.q).all()


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        ({"q0": [0.0] * 5}, er.ArrayError, "`q0` is"),
        ({"q1": [0.0] * 5 + [np.nan]}, er.ArrayError, "`q1` is"),
        ({"q1": "home"}, er.ArrayError, "`q1` is not a row of numbers"),
        ({"robot": "nobody"}, er.FileError, "nobody"),
        ({"q1": [9.0] * 6}, er.FileError, "limit"),
        ({"time_limit_s": -1.0}, er.ArgumentError, "seconds above 0"),
        ({"planner": "prm"}, er.ArgumentError, "rrt-connect"),
        ({"clearance_m": np.nan}, er.Error, "clearance"),
    ],
)
def test_what_cannot_be_planned_teaches(exchange: Path, change: dict[str, object], error: type, text: str) -> None:
    words = {"robot": "left", "q0": [1.0, 0.9, 0.2, 0, 0.8, 0], "q1": [-1.0, 0.9, 0.2, 0, 0.8, 0], **change}
    with pytest.raises(error, match=text):
        er.plan(er.Cell.load(exchange), **words)  # type: ignore[arg-type]


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
