"""Monitors: the overrides of a run, faults, switches."""

from __future__ import annotations

import math
import pickle
import threading
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import elbowroom as er
from conftest import ROOT

CELL = """
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[region.end]
shape = "box"
from = [-500, -500, 1000]
to = [500, 500, 1500]
warning = 400
guards = ["tcp"]
[region.lamp]
shape = "sphere"
centre = [0, 0, 0]
radius = 100
warning = 100
guards = ["tcp"]
life = "temporary"
"""


@pytest.fixture
def monitor(tmp_path_factory: pytest.TempPathFactory) -> er.Monitor:
    """A rail that ends at a region, and begins in one that is off at first."""
    file = tmp_path_factory.mktemp("cell") / "cell.toml"
    file.write_text(CELL)
    return er.Monitor(er.Cell.load(file))


def test_the_overrides_along_a_recording_are_those_of_the_run() -> None:
    # Its law needs positions alone.
    cell = er.Cell.load(ROOT / "examples/full_speed/cell.toml")
    trace = cell.run().trace()
    found = er.Monitor(cell).evaluate(trace.times_s, trace.q)
    assert found.robots == cell.robots and found.speed_override.shape == (len(trace.times_s), 1)
    assert (found.speed_override[:, 0] == trace.speed_override).all() and found.speed_override.min() < 0.9
    assert {event for *_, event in found.events} >= {"warn_in"}
    assert (found.times_s == trace.times_s).all() and len(found.reason) == len(trace.times_s)


@pytest.mark.parametrize("name", ["figure12", "exchange", "conveyor"])
def test_told_velocities_and_intents_the_overrides_are_those_of_the_run(name: str) -> None:
    cell = er.Cell.load(ROOT / f"examples/{name}/cell.toml")
    run, monitor = cell.run(), er.Monitor(cell)
    traces = [run.trace(robot) for robot in cell.robots]
    q, qd, intent = (np.hstack([getattr(trace, what) for trace in traces]) for what in ("q", "qd", "intent"))
    found = monitor.evaluate(traces[0].times_s, q, qd, intent=intent)
    for robot, trace in enumerate(traces):
        assert trace.qd.shape == trace.intent.shape == trace.q.shape
        # Programs that ask for less than the whole override have it in their trace.
        differ = found.speed_override[:, robot] != trace.speed_override
        assert not differ.any(), (name, trace.robot, differ.sum(), trace.times_s[differ][:3])
        # The velocities are those of the motion.
        steps = np.diff(trace.q, axis=0) / np.diff(trace.times_s)[:, None]
        assert np.abs(steps - 0.5 * (trace.qd[1:] + trace.qd[:-1])).max() < 0.2
    assert found.speed_override.min() < 0.9


def test_the_override_falls_with_the_distance(monitor: er.Monitor) -> None:
    assert (monitor.robots, monitor.joints, monitor.regions) == (["rail"], ["rail.joint_1"], ["end", "lamp"])
    for k, z_m in enumerate(np.linspace(0.2, 0.9, 8)):
        # Slowly enough that no joint is faster than its limit.
        tick = monitor.tick(2.0 * k, [z_m])["rail"]
        distance_m = 1.0 - z_m
        assert tick.speed_override == pytest.approx(min(1.0, distance_m / 0.4), abs=1e-9)
        assert monitor.distance("rail", "end") == pytest.approx(distance_m, abs=1e-9)
        if tick.speed_override < 1:
            assert tick.region == "end" and tick.distance_m == pytest.approx(distance_m) and "end" in tick.reason
        else:
            assert (tick.region, tick.distance_m, tick.reason) == (None, None, "free")
        assert tick.events == ((("end", "warn_in"),) if k == 5 else ())
        assert tick == er.Tick(*(getattr(tick, name) for name in tick.__dataclass_fields__))


def test_what_is_no_measurement_is_override_0_with_a_reason(monitor: er.Monitor) -> None:
    assert monitor.tick(0.0, [0.3])["rail"].speed_override == 1.0
    for q in (math.nan, math.inf, -math.inf):
        tick = monitor.tick(0.002, np.array([q]))["rail"]
        assert tick.speed_override == 0.0 and tick.is_fault and tick.reason
    # A jump, and time that stands still or does not exist.
    assert monitor.tick(0.004, [0.3])["rail"].is_fault is False
    assert monitor.tick(0.006, [0.9])["rail"].is_fault
    for now_s in (0.001, math.nan, math.inf):
        assert monitor.tick(now_s, [0.9])["rail"].speed_override == 0.0
    for k, override in enumerate((math.nan, -1.0, 2.0)):
        tick = monitor.tick(2.0 + k, [0.3], programmed_override=override)["rail"]
        assert tick.speed_override == 0.0 and tick.is_fault
    assert monitor.tick(9.0, [0.3], programmed_override=0.5)["rail"].speed_override <= 0.5


def test_a_distance_that_was_not_measured_is_no_number(monitor: er.Monitor) -> None:
    assert math.isnan(monitor.distance("rail", "end"))
    monitor.tick(0.0, [0.5])
    assert monitor.distance("rail", "end") == pytest.approx(0.5)
    monitor.tick(0.002, [math.nan])
    assert math.isnan(monitor.distance("rail", "end"))
    for limit_m in (math.nan, -1.0):
        with pytest.raises(er.ArgumentError, match="`limit_m` is"):
            monitor.distance("rail", "end", limit_m)


def test_an_evaluation_goes_on_until_it_begins_anew(monitor: er.Monitor) -> None:
    times_s, q = np.arange(600) * 0.002, np.full((600, 1), 0.8)
    whole = monitor.evaluate(times_s, q).speed_override
    assert np.abs(whole - 0.5).max() < 1e-9 and (monitor.evaluate(times_s, q).speed_override == 0.0).any()
    monitor.reset()
    parts = [monitor.evaluate(times_s[part], q[part]).speed_override for part in (slice(0, 250), slice(250, 600))]
    assert (np.vstack(parts) == whole).all()
    # A row with NaN is found before the first tick.
    monitor.reset()
    with pytest.raises(er.ArrayError, match="row 599"):
        monitor.evaluate(times_s, np.vstack([q[:-1], [[np.nan]]]))
    assert (monitor.evaluate(times_s, q).speed_override == whole).all()


def test_threads_take_turns_and_copies_are_refused(monitor: er.Monitor) -> None:
    times_s, q = np.arange(20_000) * 0.002, np.full((20_000, 1), 0.8)
    found: list[npt.NDArray[np.float64]] = []
    worker = threading.Thread(target=lambda: found.append(monitor.evaluate(times_s, q).speed_override))
    worker.start()
    while worker.is_alive():
        assert monitor.robots == ["rail"] and monitor.is_active("end") and "rail" not in repr(monitor)
    worker.join()
    assert np.abs(found[0] - 0.5).max() < 1e-9
    with pytest.raises(er.ArgumentError, match="in each process"):
        pickle.dumps(monitor)


def test_a_mechanism_is_not_guarded(tmp_path: Path) -> None:
    text = CELL.replace("[region.end]", '''[robot.door]
kind = "mechanism"
base = { at = [5000, 0, 0] }
dh = [{ min = -90, max = 90, speed = 45 }]
links = [{ sphere = { radius = 50 } }]
[region.end]''')
    (tmp_path / "cell.toml").write_text(text)
    monitor = er.Monitor(er.Cell.load(tmp_path / "cell.toml"))
    assert monitor.robots == ["rail"] and len(monitor.joints) == 2
    q = dict(zip(monitor.joints, [0.3, 0.3]))
    assert list(monitor.tick(0.0, list(q.values()))) == ["rail"]
    assert monitor.evaluate([0.002], np.array([[0.3, 0.3]])).speed_override.shape == (1, 1)


def test_regions_are_switched(monitor: er.Monitor) -> None:
    assert not monitor.is_active("lamp") and monitor.is_active("end")
    assert monitor.tick(0.0, [0.05])["rail"].speed_override == 1.0 and monitor.distance("rail", "lamp") == math.inf
    monitor.switch("lamp", True)
    assert monitor.tick(0.002, [0.05])["rail"].speed_override == 0.0 and monitor.is_active("lamp")
    assert monitor.distance("rail", "lamp") == 0.0 and monitor.distance("rail", "end", limit_m=0.5) == math.inf
    monitor.switch("lamp", False)
    assert monitor.tick(2.0, [0.05])["rail"].speed_override > 0.0 and not monitor.is_active("lamp")
    with pytest.raises(er.ArgumentError, match="`end` is permanent"):
        monitor.switch("end", False)
    with pytest.raises(er.ArgumentError, match='no region is called "x"\n  write: end, lamp'):
        monitor.switch("x", True)
    with pytest.raises(er.ArgumentError, match='no robot is called "x"\n  write: one of rail'):
        monitor.distance("x", "end")


def test_two_robots_grant_each_other_a_region(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    run = cell.run()
    traces = [run.trace(robot) for robot in cell.robots]
    q = np.ascontiguousarray(np.hstack([trace.q for trace in traces]))
    # Velocities as differences, for the intents too: grants need no more.
    qd = np.gradient(q, traces[0].times_s, axis=0)
    found = er.Monitor(cell).evaluate(traces[0].times_s, q, qd, intent=qd)
    assert found.robots == cell.robots and found.speed_override.shape == (len(q), 2)
    granted = [(robot, region) for _, robot, region, event in found.events if event == "granted"]
    assert {robot for robot, _ in granted} == set(cell.robots) and len({region for _, region in granted}) == 1


def test_wrong_arrays_say_what_to_write(monitor: er.Monitor) -> None:
    with pytest.raises(er.ArrayError, match="write: 1 numbers: rail.joint_1"):
        monitor.tick(0.0, [0.1, 0.2])
    with pytest.raises(er.ArrayError, match="`qd`"):
        monitor.tick(0.0, [0.1], [0.1, 0.2])
    rows = np.array([[0.1], [0.1], [0.1]])
    with pytest.raises(er.ArrayError, match=r"`times_s` has 2 values, `q` 3 rows\n  write: a time for each row"):
        monitor.evaluate([0.0, 0.002], rows)
    with pytest.raises(er.ArrayError, match="`qd` 2 rows"):
        monitor.evaluate([0.0, 0.002, 0.004], rows, rows[:2].copy())
    with pytest.raises(er.ArrayError, match="row 1, column 0 is NaN"):
        monitor.evaluate([0.0, 0.002], np.array([[0.1], [np.nan]]))
    for times in ("abc", None, np.zeros((3, 1))):
        with pytest.raises(er.ArrayError, match="`times_s` is not a row of numbers"):
            monitor.evaluate(times, rows)  # type: ignore[arg-type]
    empty = monitor.evaluate([], np.zeros((0, 1)))
    assert empty.speed_override.shape == (0, 1) and empty.reason == [] and empty.events == []
