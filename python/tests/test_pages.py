"""Pages of robots, cells and paths, in files and notebooks."""

from __future__ import annotations

import pickle
import re
import webbrowser
from pathlib import Path

import pytest

import elbowroom as er
from conftest import ROOT
from elbowroom.pages import Paged


def outside(page: str) -> list[str]:
    """What a browser might fetch: addresses, but for names of XML."""
    return [found for found in re.findall(r"(?:https?|wss?)://[^\s\"'<>)]+", page) if "w3.org" not in found]


def check(source: Paged, names: list[str]) -> None:
    page = source.page()
    assert page.startswith("<!DOCTYPE html>") and not outside(page) and len(page) > 20_000
    missing = [name for name in names if name not in page]
    assert not missing, missing
    frame = source._repr_html_()  # type: ignore[attr-defined]
    assert frame.startswith("<iframe") and 'srcdoc="&lt;!DOCTYPE' in frame


def test_a_robot_shows_itself(rx60b: Path) -> None:
    robot = er.Robot.load(rx60b, rx60b.with_suffix(".srdf"))
    # Its joints have sliders, whose names are in compressed data; its levels are a table.
    check(robot, [robot.name, ">L1<", ">L3<", "</canvas>"])


def test_a_robot_shows_itself_from_another_folder(rx60b: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(rx60b.parent)
    robot = er.Robot.load(rx60b.name)
    monkeypatch.chdir(tmp_path)
    assert robot.page().startswith("<!DOCTYPE html>")


def test_a_copied_path_has_its_arrays_and_what_has_no_page_is_told(exchange: Path, tmp_path: Path) -> None:
    path = er.Planner(er.Cell.load(exchange), "left").plan([1.0, 0.9, 0.2, 0, 0.8, 0], [0.9, 0.9, 0.2, 0, 0.8, 0])
    copied = pickle.loads(pickle.dumps(path))
    assert (copied.q == path.q).all() and copied.found
    with pytest.raises(er.ArgumentError, match="a copied path has no cell"):
        copied.page()
    with pytest.raises(er.ArgumentError, match="a int has no page"):
        er.save(5, tmp_path / "page.html")  # type: ignore[arg-type]


def test_a_cell_and_a_path_show_the_scene(exchange: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cell = er.Cell.load(exchange)
    check(cell, cell.robots)
    path = er.Planner(cell, "left").plan([1.0, 0.9, 0.2, 0, 0.8, 0], [-1.0, 0.9, 0.2, 0, 0.8, 0])
    check(path, cell.robots)
    # The time of the path is that of the run in which the robot plays it.
    told = re.search(r"left[^.]*?finished[^.]*?([0-9.]+) s", path.page())
    assert told is not None and float(told[1]) == pytest.approx(path.duration_s, abs=0.05), path.duration_s
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    file = er.show(path)
    assert opened == [file.as_uri()] and len(file.read_text(encoding="utf-8")) > 20_000
    file.unlink()
    assert er.save(cell, tmp_path / "cell.html").stat().st_size > 20_000


def test_a_cell_whose_arm_a_person_guides_has_a_page_at_once() -> None:
    cell = er.Cell.load(ROOT / "examples/guided/cell.toml")
    check(cell, cell.robots)
    planner = er.Planner(er.Cell.load(ROOT / "examples/exchange/cell.toml"), "left")
    check(planner.plan([1.0, 0.9, 0.2, 0, 0.8, 0], [1.0, 0.9, 0.2, 0, 0.8, 0]), ["left"])
