"""Arms that a person guides, step by step."""

from __future__ import annotations

import copy
import shutil
import threading
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import elbowroom as er
from conftest import ROOT
from elbowroom.poses import row

GUIDED = ROOT / "examples/guided/cell.toml"


@pytest.fixture(scope="module")
def arm() -> er.GuidedArm:
    return er.GuidedArm(er.Cell.load(GUIDED))


def towards(arm: er.GuidedArm, offset_m: list[float], steps: int) -> npt.NDArray[np.float64]:
    """Poses from the tool to a point beside it, evenly."""
    start, poses = row(arm.tool), np.empty((steps, 7))
    poses[:] = start
    poses[:, :3] += np.linspace(0.0, 1.0, steps)[:, None] * np.array(offset_m)
    return poses


def test_the_tool_follows_the_hand_and_stops_on_the_surface(arm: er.GuidedArm) -> None:
    arm.reset()
    assert (arm.robot, len(arm.joints), arm.period_s) == ("ns16", 6, 0.002)
    start = arm.tool
    poses = towards(arm, [0.0, 0.0, -0.3], 2500)
    found = arm.follow(poses)
    assert found.joints == arm.joints and found.q.shape == (2500, 6) and found.tool.shape == (2500, 4, 4)
    assert (found.q[-1] == arm.q).all() and (found.tool[-1] == arm.tool).all()
    # The tool is where the joints hold it.
    robot = er.Robot.load(ROOT / "examples/models/ns16/ns16.urdf")
    fk = robot.fk(found.q)
    offset = np.linalg.inv(fk[0]) @ found.tool[0]
    assert np.abs(fk @ offset - found.tool).max() < 1e-6
    # It follows until the shield above the work piece, whose face is at 1240 mm, and does not enter it.
    height = found.tool[:, 2, 3]
    assert 1.245 < height.min() and height[-1] < 1.25 and poses[-1, 2] < 1.23
    assert found.limit[0] is None and found.limit[-1] == "surface" and 0.0 <= found.gap_m[-1] < 2e-3
    follows = [limit is None for limit in found.limit[:200]]
    assert sum(follows) > 100 and np.abs(found.tool[:100, :2, 3] - start[:2, 3]).max() < 1e-3


def test_steps_are_those_of_a_motion(arm: er.GuidedArm) -> None:
    arm.reset()
    poses = towards(arm, [0.02, 0.05, -0.1], 120)
    together = arm.follow(poses)
    arm.reset()
    for number, pose in enumerate(poses):
        step = arm.step((pose[:3], pose[3:]))
        assert (step.q == together.q[number]).all() and (step.tool == together.tool[number]).all()
        assert step.limit == together.limit[number] and step.limited_by == together.limited_by[number]


def test_the_arm_stands_without_the_hand_and_under_override_0(arm: er.GuidedArm) -> None:
    arm.reset()
    before, pose = arm.q, towards(arm, [0.0, 0.05, 0.0], 2)[1]
    assert (arm.step(None).q == before).all()
    assert (arm.step((pose[:3], pose[3:]), speed_override=0.0).q == before).all()
    assert (arm.step((pose[:3], pose[3:])).q != before).any()
    # In motion it comes to rest in some steps when the switch is released.
    moving = arm.follow(np.tile(pose, (100, 1)))
    last = np.abs(np.diff(moving.q[-2:], axis=0)).max()
    rest = [arm.step(None).q for _ in range(200)]
    assert last > 1e-5 and (rest[-1] == rest[-2]).all() and np.abs(np.diff(rest, axis=0)).max() <= 1.01 * last


def test_what_keeps_an_arm_from_following_has_a_name(arm: er.GuidedArm) -> None:
    arm.reset()
    found = arm.follow(towards(arm, [3.0, 0.0, 0.5], 4000))
    assert found.limit[-1] in ("reach", "contact", "joint speed")
    named = {by for limit, by in zip(found.limit, found.limited_by, strict=True) if limit in ("contact", "joint speed")}
    parts = {*arm.joints, "work", *(f"ns16/{link}" for link in er.Robot.load(ROOT / "examples/models/ns16/ns16.urdf").links)}
    assert named and named <= parts, named
    assert all(by is None for limit, by in zip(found.limit, found.limited_by, strict=True) if limit in (None, "surface", "reach"))


def test_a_recorded_hand_leads_as_in_a_run(tmp_path: Path) -> None:
    shutil.copytree(GUIDED.parent, tmp_path / "guided")
    shutil.copytree(ROOT / "examples/models", tmp_path / "models")
    file = tmp_path / "guided/hand.csv"
    # The first half: the hand pushes into the work, and draws the tool across it.
    file.write_text("\n".join(file.read_text().splitlines()[:91]) + "\n")
    rows = np.genfromtxt(file, delimiter=",", skip_header=1)
    cell = er.Cell.load(tmp_path / "guided/cell.toml")
    trace = cell.run(monitor=False).trace()
    # The file is in millimetres, and read between its rows; its tool never turns.
    assert (rows[:, 4:] == rows[0, 4:]).all()
    times = trace.times_s[trace.times_s <= rows[-1, 0]]
    poses = np.tile(rows[0, 1:], (len(times), 1))
    poses[:, :3] = 1e-3 * np.stack([np.interp(times, rows[:, 0], rows[:, axis]) for axis in (1, 2, 3)], axis=1)
    arm = er.GuidedArm(cell)
    assert (arm.q == trace.q[0]).all() and len(times) > 2000
    found = arm.follow(poses)
    assert np.abs(found.q[:-1] - trace.q[1 : len(times)]).max() < 1e-6
    assert {"surface"} <= set(found.limit)


def test_threads_take_turns_and_copies_are_refused(arm: er.GuidedArm) -> None:
    arm.reset()
    pose = towards(arm, [0.0, 0.1, 0.0], 2)[1:]
    alone = arm.follow(np.repeat(pose, 192, axis=0))
    arm.reset()
    parts: list[er.Guidance] = []
    threads = [threading.Thread(target=lambda: parts.append(arm.follow(np.repeat(pose, 64, axis=0)))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # All lead to the same pose, so the steps together are those of one thread, in whatever order threads make them.
    together = {q.tobytes() for part in parts for q in part.q}
    assert len(parts) == 3 and together == {q.tobytes() for q in alone.q} and (arm.q == alone.q[-1]).all()
    with pytest.raises(er.ArgumentError, match="has a state"):
        copy.copy(arm)


def test_what_cannot_be_guided_teaches(arm: er.GuidedArm) -> None:
    cell = er.Cell.load(GUIDED)
    with pytest.raises(er.ArgumentError, match='no operator is called "hands"\n  write: .*hand'):
        er.GuidedArm(cell, "hands")
    with pytest.raises(er.ArgumentError, match="has no operator"):
        er.GuidedArm(er.Cell.load(ROOT / "examples/figure12/cell.toml"))
    for wrong in (np.zeros((1, 7)), np.full((1, 7), np.nan), np.zeros((1, 6)), [[0.0] * 7]):
        with pytest.raises(er.ArrayError, match="`poses`"):
            arm.follow(wrong)  # type: ignore[arg-type]
    for share in (-0.1, 1.1, np.nan):
        with pytest.raises(er.ArgumentError, match="`speed_override`"):
            arm.step(np.eye(4), speed_override=share)
    with pytest.raises(er.ArrayError, match="`pose`"):
        arm.step(np.eye(3))
