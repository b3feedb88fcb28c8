"""Arms that act as one, step by step."""

from __future__ import annotations

import copy
import shutil
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import elbowroom as er
from conftest import ROOT

INSPECTION = ROOT / "examples/inspection"
#: The tick of the cell, in which the work-piece is desired anew.
TICK_S = 0.004


@pytest.fixture(scope="module")
def trio() -> er.VirtualRobot:
    return er.VirtualRobot(er.Cell.load(INSPECTION / "cell.toml"))


def desired(until_s: float) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Times, and the rows of the example at each tick: metres and quaternions."""
    rows = np.genfromtxt(INSPECTION / "bar.csv", delimiter=",", skip_header=1)
    # Rounded as in a run.
    times = np.round(TICK_S * np.arange(round(until_s / TICK_S)), 9)
    poses = np.stack([np.interp(times, rows[:, 0], rows[:, column]) for column in range(1, 8)], axis=1)
    poses[:, :3] *= 1e-3
    return times, poses


def test_arms_are_led_as_in_a_run(tmp_path: Path) -> None:
    times, poses = desired(9.5)
    in_file = np.column_stack([times, 1e3 * poses[:, :3], poses[:, 3:]])
    lines = [",".join(map(repr, values)) for values in in_file.tolist()]
    shutil.copytree(INSPECTION, tmp_path / "inspection")
    shutil.copytree(ROOT / "examples/models", tmp_path / "models")
    file = tmp_path / "inspection/bar.csv"
    file.write_text("\n".join(["t_s,x,y,z,qx,qy,qz,qw", *lines, ""]))
    cell = er.Cell.load(tmp_path / "inspection/cell.toml")
    run = cell.run(monitor=False)
    trio = er.VirtualRobot(cell)
    poses[:, :3] = 1e-3 * in_file[:, 1:4]
    found = trio.follow(poses)
    robots = [run.trace(robot) for robot in trio.robots]
    expected = np.hstack([trace.q for trace in robots])
    assert (expected[0] == cell.start).all() and found.joints == trio.joints == cell.joints
    error = np.abs(found.q[:-1] - expected[1 : len(poses)])
    # Arms that wait react to the last bit of the poses, which a run reads from the file; the arm that carries does not.
    assert error[:, :6].max() < 1e-9 and error.max() < 0.1
    part = run.objects["bar"]
    assert np.abs(found.part[:-1] - part[1 : len(poses)]).max() < 1e-9
    # It was handed over at the same time for the same reason.
    (told,) = [(number * TICK_S, why) for number, why in enumerate(found.handed_over) if why]
    first = run.summary["virtual_robots"][0]["hand_overs"][0]
    assert told[0] == pytest.approx(first["t_s"], abs=1e-9) and told[1] == first["reason"]
    assert (found.holder[0], found.holder[-1]) == ("one", first["to"]) and found.gap_m.min() > 0.0
    # The holder has it in its hand: the pose of the tool in the work-piece stays.
    tool = cell.fk(found.q[:1000].copy())["one/tool0"]
    in_part = np.linalg.inv(found.part[:1000]) @ tool
    assert np.abs(in_part - in_part[0]).max() < 1e-6


def test_the_work_piece_goes_on_to_the_last_pose_and_stands_without_the_hand(trio: er.VirtualRobot) -> None:
    trio.reset()
    start, there = trio.part, trio.part
    there[1, 3] += 0.02
    step = trio.step(there)
    assert trio.left_s > 0.01 and isinstance(step, er.CooperationStep) and step.q.shape == (len(trio.joints),)
    under_way = trio.go_on(60)
    moved = np.linalg.norm(trio.part[:3, 3] - start[:3, 3])
    assert 1e-4 < moved < 0.02 and under_way.rate.max() > 0.0
    # The switch is released.
    rest = [trio.step(None) for _ in range(200)]
    assert (rest[-1].part == rest[-2].part).all() and rest[-1].rate == 0.0 and rest[-1].hold is not None
    # It stands until the next pose.
    assert (trio.go_on(20).part == rest[-1].part).all()
    stands = trio.go_on(5, speed_override=0.0)
    assert (stands.part == rest[-1].part).all()
    trio.step(there)
    trio.go_on(2000)
    assert np.abs(trio.part - there).max() < 1e-6 and trio.left_s < 1e-6 and trio.holder == "one"
    trio.reset()
    assert (trio.part == start).all()


def test_what_cannot_be_done_teaches(trio: er.VirtualRobot) -> None:
    with pytest.raises(er.ArgumentError, match=r"has no virtual robot\n  write: \[virtual_robot.NAME\]"):
        er.VirtualRobot(er.Cell.load(ROOT / "examples/figure12/cell.toml"))
    with pytest.raises(er.ArgumentError, match='no virtual robot is called "duo"\n  write: .*trio'):
        er.VirtualRobot(er.Cell.load(INSPECTION / "cell.toml"), "duo")
    with pytest.raises(er.ArrayError, match="`speed_override`"):
        trio.step(trio.part, speed_override=[1.0])
    with pytest.raises(er.ArgumentError, match="`speed_override` is 3"):
        trio.step(trio.part, speed_override=3.0)
    with pytest.raises(er.ArgumentError, match="`speed_override` is 2"):
        trio.step(trio.part, speed_override=[1.0, 2.0, 1.0])
    for steps in (0, -1, 10**7):
        with pytest.raises(er.ArgumentError, match="`steps`"):
            trio.go_on(steps)
    before = trio.part
    far = (before[:3, 3] + 1e7, [0, 0, 0, 1])
    with pytest.raises(er.ArgumentError, match="the desired pose"):
        trio.step(far)
    assert (trio.part == before).all()
    with pytest.raises(er.ArgumentError, match="has a state"):
        copy.copy(trio)
