"""Trajectories."""

from __future__ import annotations

import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elbowroom as er
from conftest import ROOT

JOINTS = ["a", "b"]


@given(
    st.lists(st.tuples(*[st.floats(-3, 3)] * 2), min_size=1, max_size=6),
    st.tuples(*[st.floats(0.1, 5)] * 6),
    st.floats(0.0, 1.0),
)
@settings(max_examples=60, deadline=None)
def test_the_fastest_motion_keeps_its_limits_and_its_ends(
    waypoints: list[tuple[float, float]], limits: tuple[float, ...], blend: float
) -> None:
    velocity, acceleration, jerk = np.reshape(limits, (3, 2))
    period = 0.01
    motion = er.Trajectory.time_optimal(
        waypoints, velocity=velocity, acceleration=acceleration, jerk=5 * jerk, blend=blend, period_s=period, joints=JOINTS
    )
    assert motion.joints == JOINTS and np.abs(motion.q[0] - waypoints[0]).max() < 1e-9
    assert np.abs(motion.q[-1] - waypoints[-1]).max() < 1e-9
    if len(motion) > 1:
        rates = motion.velocities()
        assert (np.abs(rates) <= velocity * (1 + 1e-6) + 1e-9).all()
        # At rest at the ends: a change of the mean velocity of a period is at most that of the acceleration.
        padded = np.vstack([np.zeros(2), rates, np.zeros(2)])
        assert (np.abs(np.diff(padded, axis=0)) <= acceleration * period * (1 + 1e-6) + 1e-7).all()


def test_corners_are_passed_sooner_with_blends() -> None:
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    rest, blended = (er.Trajectory.time_optimal(corners, velocity=1, acceleration=4, jerk=40, blend=b) for b in (0.0, 0.3))
    assert blended.duration_s < rest.duration_s - 0.2
    # Without a blend it goes through the corner.
    assert np.abs(rest.q - [1.0, 0.0]).sum(axis=1).min() < 1e-6 < np.abs(blended.q - [1.0, 0.0]).sum(axis=1).min()


def test_values_are_linear_between_the_rows() -> None:
    motion = er.Trajectory([1.0, 2.0, 4.0], [[0, 10], [1, 20], [3, 0]])
    assert motion.at(1.5).tolist() == [0.5, 15.0] and motion.at([0.0, 3.0, 9.0]).tolist() == [[0, 10], [2, 10], [3, 0]]
    assert (motion.duration_s, len(motion), motion.joints) == (3.0, 3, ["joint_1", "joint_2"])
    assert motion.velocities().tolist() == [[1, 10], [1, -10]]
    back = motion.reversed()
    assert back.times_s.tolist() == [1.0, 3.0, 4.0] and (back.at(2.0) == motion.at(3.0)).all() and back.reversed() == motion
    rows = motion.resampled(0.7)
    assert np.allclose(rows.times_s, [1.0, 1.7, 2.4, 3.1, 3.8, 4.0]) and (rows.q == motion.at(rows.times_s)).all()
    # Joints have their names, whatever their order.
    named = er.Trajectory([0, 1], [[1, 2], [3, 4]], JOINTS)
    assert named.ordered(["b", "a"]).q.tolist() == [[2, 1], [4, 3]] and motion.ordered(JOINTS).joints == JOINTS
    with pytest.raises(er.ArgumentError, match="the trajectory is of a, b"):
        named.ordered(["a", "c"])
    assert motion.resampled(1.0).times_s.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert pickle.loads(pickle.dumps(motion)) == motion != back
    with pytest.raises(ValueError, match="read-only"):
        motion.q[0, 0] = 5.0


def test_files_read_back_to_the_same_bits(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    motion = er.Trajectory(np.cumsum(rng.uniform(1e-9, 1, 50)), rng.normal(size=(50, 2)) * 10.0 ** rng.integers(-9, 9, (50, 2)), JOINTS)
    assert er.Trajectory.load(motion.save(tmp_path / "motion.csv")) == motion


def test_a_path_is_played_in_its_cell(exchange: Path, tmp_path: Path) -> None:
    cell = er.Cell.load(exchange)
    path = er.Planner(cell, "left").plan([1.0, 0.9, 0.2, 0, 0.8, 0], [0.9, 0.9, 0.2, 0, 0.8, 0])
    motion = path.trajectory
    assert (motion.q == path.q).all() and motion.joints == path.joints
    # As the path itself, but for the title.
    assert abs(len(cell.page({"left": motion})) - len(path.page())) < 2000
    # In any order of the joints.
    turned = er.Trajectory(motion.times_s, motion.q[:, ::-1], motion.joints[::-1])
    ends = [re.search(r"left[^.]*?finished[^.]*?([0-9.]+) s", cell.page({"left": of})) for of in (motion, turned)]
    assert ends[0] is not None and ends[1] is not None and ends[0][1] == ends[1][1]
    # A cell file takes it.
    (tmp_path / "exchange").mkdir()
    scene = er.Scene()
    scene.add_robot("arm", ROOT / "examples/models/rx60b/rx60b.urdf")
    scene.add("program", "arm", trajectory=motion.save(tmp_path / "motion.csv"))
    trace = scene.cell().run(monitor=False).trace()
    assert np.abs(trace.trajectory.at(motion.times_s) - motion.q).max() < 1e-6


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "motion.csv:1"),
        ("time,a\n0,1\n", "motion.csv:1"),
        ("t_s,a\n", "motion.csv:1.*has no row"),
        ("t_s,a\n0,1\n1,x\n", "motion.csv:3"),
        ("t_s,a\n0,1\n\n1,nan\n", "motion.csv:4"),
        ("\ufefft_s,a\n0,1\n0,2\n", r"motion.csv:3: is not later"),
        ("t_s,a\n0,1,2\n", r"motion.csv:2: has 3 values\n  write: 2 finite numbers"),
    ],
)
def test_files_that_are_none_are_told_with_their_line(text: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "motion.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(er.FileError, match=told):
        er.Trajectory.load(file)


def test_what_is_no_trajectory_teaches(exchange: Path) -> None:
    for times, q in (([0, 0], [[1], [2]]), ([0, 1], [[1]]), ([], np.zeros((0, 1))), ([0], [1]), ([np.nan], [[1]]), (["a"], [[1]])):
        with pytest.raises(er.ArrayError, match="write: "):
            er.Trajectory(times, q)
    with pytest.raises(er.ArgumentError, match="3 names of 1 joints"):
        er.Trajectory([0], [[1]], ["a", "b", "c"])
    limits: dict[str, Any] = {"velocity": 1.0, "acceleration": 1.0, "jerk": 1.0}
    odd: list[dict[str, Any]] = [{"velocity": 0.0}, {"jerk": np.inf}, {"blend": -1.0}, {"blend": np.nan}, {"period_s": 0.0}, {"period_s": 1e-9}]
    for wrong in odd:
        with pytest.raises(er.ArgumentError, match="write: |give "):
            er.Trajectory.time_optimal([[0.0], [1.0]], **limits | wrong)
    with pytest.raises(er.ArrayError, match="complex numbers"):
        er.Trajectory([0.0, 1.0], [[0.0], [1.0]]).at(0.5 + 1j)
    with pytest.raises(er.ArrayError, match="`velocity`"):
        er.Trajectory.time_optimal([[0.0], [1.0]], **limits | {"velocity": [1.0, 2.0]})
    for period in (1e-9, 0.0, -1.0, np.inf, np.nan):
        with pytest.raises(er.ArgumentError, match="`period_s`"):
            er.Trajectory([0, 1], [[0], [1]]).resampled(period)
    for names in (["a,b"], [" a"], ['"q'], [""], ["a\nb"], [1]):
        with pytest.raises(er.ArgumentError, match="a joint is called"):
            er.Trajectory([0], [[0]], names)  # type: ignore[arg-type]
    with pytest.raises(er.ArgumentError, match="two joints have the same name"):
        er.Trajectory([0], [[0, 0]], ["a", "a"])
    with pytest.raises(er.FileError, match="cannot be written"):
        er.Trajectory([0], [[0]]).save("/nowhere/motion.csv")
    cell = er.Cell.load(exchange)
    with pytest.raises(er.ArgumentError, match='no robot is called "centre"'):
        cell.page({"centre": er.Trajectory([0], [[0.0] * 6])})
    with pytest.raises(er.ArgumentError, match="the trajectory is of joint_1, .*joint_5"):
        cell.page({"left": er.Trajectory([0], [[0.0] * 5])})
    with pytest.raises(er.ArgumentError, match='the motion of "left" is a int'):
        cell.page({"left": 5})  # type: ignore[dict-item]
