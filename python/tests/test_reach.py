"""What a robot reaches: its states bring the tool to the target, and nothing touches in them."""

from __future__ import annotations

import functools
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elbowroom as er
from conftest import ROOT
from elbowroom.poses import matrix

RX60B = ROOT / "examples/models/rx60b/rx60b.urdf"


def frames(robot: er.Robot, count: int, seed: int) -> npt.NDArray[np.float64]:
    """Return frames of the tip at random states, as rows."""
    low, high = robot.limits.T
    q = np.random.default_rng(seed).uniform(low, high, (count, robot.dof))
    poses = robot.fk(q)
    rows = np.empty((count, 7))
    rows[:, :3] = poses[:, :3, 3]
    # The eigenvector of the largest eigenvalue (Bar-Itzhack, 2000) is the quaternion.
    for row, m in zip(rows, poses[:, :3, :3], strict=True):
        k = np.array(
            [
                [m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
                [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
                [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
                [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], np.trace(m)],
            ]
        )
        row[3:] = np.linalg.eigh(k)[1][:, -1]
    return rows


def test_a_robot_reaches_where_it_has_been() -> None:
    robot = er.Robot.load(RX60B)
    targets = frames(robot, 300, 1)
    found = er.ReachQuery(robot).evaluate(targets)
    assert (found.solutions > 0).all() and 0 < (found.free > 0).sum() < 300
    assert (found.free <= found.solutions).all() and (np.isnan(found.q[:, 0]) == (found.free == 0)).all()
    free = found.free > 0
    assert not er.Checker(robot).collides(np.ascontiguousarray(found.q[free])).any()
    wanted = np.array([matrix((row[:3], row[3:])) for row in targets[free]])
    assert np.abs(robot.fk(np.ascontiguousarray(found.q[free])) - wanted).max() < 1e-7
    none_free = er.Checker(robot)
    for row in targets[~free][:20]:
        assert none_free.collides(robot.ik((row[:3], row[3:]))).all()


def test_threads_pickles_and_places(exchange: Path) -> None:
    cell = er.Cell.load(exchange)
    query = er.ReachQuery(cell, "right", turns=3)
    points = np.random.default_rng(5).uniform([-0.4, -0.3, 0.42], [0.4, 0.3, 0.8], (60, 3))
    targets = np.hstack([points, np.tile([0.2, 0.0, -3.0], (60, 1))])
    base = query.base.copy()
    base[:2, 3] += 0.2
    for place in (None, base):
        expected = query.evaluate(targets, place)
        for other in (pickle.loads(pickle.dumps(query)), er.ReachQuery(cell, "right", turns=3, threads=1)):
            found = other.evaluate(np.asfortranarray(targets), place)
            assert (found.free == expected.free).all() and (found.solutions == expected.solutions).all()
            assert np.array_equal(found.q, expected.q, equal_nan=True)
    assert query.joints[0] == "joint_1" and (query.evaluate(targets).free > 0).any()
    assert query.evaluate(np.empty((0, 6))).q.shape == (0, 6)
    # Far away nothing is in reach.
    assert not query.evaluate(targets, ([50.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])).solutions.any()


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        (np.zeros((2, 5)), r"shape \(2, 5\)"),
        (np.zeros(6), r"shape \(6,\)"),
        (np.zeros((2, 6)), "row 0 has a direction of length 0"),
        (np.zeros((2, 7)), "row 0 has a quaternion of length 0"),
        (np.full((1, 7), np.nan), "row 0, column 0 is NaN"),
        (np.zeros((2, 6), np.float32), "float64"),
        ([[0.0] * 6], "no NumPy array"),
    ],
)
def test_what_is_no_target_is_told(targets: Any, message: str) -> None:
    with pytest.raises(er.ArrayError, match=message):
        er.ReachQuery(er.Robot.load(RX60B)).evaluate(targets)


def test_what_is_no_robot_is_told(exchange: Path) -> None:
    cell, robot = er.Cell.load(exchange), er.Robot.load(RX60B)
    wrong: list[tuple[tuple[Any, ...], int, str]] = [
        ((cell,), 1, "has 2 robots"),
        ((cell, "lft"), 1, "write: left"),
        ((robot, "left"), 1, "a Robot is alone"),
        ((cell, "left"), 0, "`turns` is 0"),
        ((3,), 1, "a int reaches nothing"),
    ]
    for words, turns, message in wrong:
        with pytest.raises(er.Error, match=message):
            er.ReachQuery(*words, turns=turns)
    with pytest.raises(er.ArrayError, match="no rotation"):
        er.ReachQuery(robot).evaluate(np.ones((1, 6)), np.zeros((4, 4)))


@functools.cache
def reach_of_two_turns() -> er.ReachQuery:
    return er.ReachQuery(er.Robot.load(RX60B), turns=2)


@given(st.integers(0, 40), st.integers(0, 2**32 - 1), st.floats(-1e6, 1e6))
@settings(max_examples=40, deadline=None)
def test_random_targets_have_an_answer(count: int, seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    found = reach_of_two_turns().evaluate(rng.normal(size=(count, 6)) * size + 1e-9)
    assert found.free.shape == (count,) and (found.free <= found.solutions).all()
