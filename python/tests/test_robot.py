"""Robots: kinematics."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import elbowroom as er


def states(robot: er.Robot, count: int, seed: int = 1) -> np.ndarray:
    lower, upper = robot.limits.T
    return np.random.default_rng(seed).uniform(lower, upper, (count, robot.dof))


def test_properties(rx60b: Path) -> None:
    robot = er.Robot.load(rx60b)
    assert robot.dof == len(robot.joints) == len(robot.limits) == 6
    assert (robot.limits[:, 0] < robot.limits[:, 1]).all()
    assert robot.tip in robot.links and robot.warnings == []
    assert repr(robot) == f'Robot("rx60b": 6 joints, {len(robot.links)} links)'


def test_poses_are_rigid_and_chunks_do_not_matter(rx60b: Path) -> None:
    robot = er.Robot.load(rx60b)
    q = states(robot, 70_000)  # more than one chunk
    poses = robot.fk(q)
    turns = poses[:, :3, :3]
    assert np.abs(turns.transpose(0, 2, 1) @ turns - np.eye(3)).max() < 1e-12
    assert (poses[:, 3] == [0, 0, 0, 1]).all()
    some = [0, 511, 512, 65_535, 65_536, 69_999]
    assert (poses[some] == np.concatenate([robot.fk(q[i : i + 1]) for i in some])).all()


def test_the_jacobian_is_the_derivative(rx60b: Path) -> None:
    robot = er.Robot.load(rx60b)
    q, step, point = states(robot, 20), 1e-6, [0.1, -0.2, 0.05]

    def place(q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        found: npt.NDArray[np.float64] = (robot.fk(q, "link_4") @ np.array([*point, 1.0]))[:, :3]
        return found

    jacobian = robot.jacobian(q, "link_4", point)
    assert jacobian.shape == (20, 6, 6)
    for joint in range(6):
        moved = step * np.eye(6)[joint]
        velocity = (place(q + moved) - place(q - moved)) / (2 * step)
        assert np.abs(velocity - jacobian[:, :3, joint]).max() < 1e-7


def test_inverse_kinematics_comes_back(rx60b: Path) -> None:
    robot = er.Robot.load(rx60b)
    q = states(robot, 30)
    for row, pose in zip(q, robot.fk(q), strict=True):
        solutions = robot.ik(pose)
        turns = np.round((solutions - row) / (2 * np.pi))
        assert np.abs(solutions - row - 2 * np.pi * turns).max(axis=1).min() < 1e-6
        assert np.abs(robot.fk(solutions) - pose).max() < 1e-6
    assert robot.ik(([9.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])).shape == (0, 6)


@pytest.mark.parametrize(
    "pose",
    [
        np.eye(3),
        np.zeros((4, 4)),
        np.diag([1.0, 1.0, -1.0, 1.0]),
        np.full((4, 4), np.nan),
        ([0, 0, 0], [0, 0, 0, 0]),
        ([0, 0], [0, 0, 0, 1]),
        "home",
        None,
    ],
)
def test_what_is_no_pose_is_refused(rx60b: Path, pose: object) -> None:
    with pytest.raises(er.ArrayError, match="write: a 4x4 array"):
        er.Robot.load(rx60b).ik(pose)


def test_unknown_links_and_files_teach(rx60b: Path, tmp_path: Path) -> None:
    robot = er.Robot.load(rx60b)
    q = np.zeros((1, 6))
    with pytest.raises(er.ArgumentError, match='no link "link_44"\n  write: '):
        robot.fk(q, "link_44")
    with pytest.raises(er.ArgumentError, match="3 finite numbers: x, y, z"):
        robot.jacobian(q, point=[0.0, np.inf, 0.0])
    with pytest.raises(er.ArgumentError, match="`ft` is no unit"):
        er.Robot.load(rx60b, unit="ft")
    broken = tmp_path / "arm.urdf"
    broken.write_text("<robot name='a'>\n<link name='l'/>\n<joint/>\n</robot>")
    with pytest.raises(er.FileError) as found:
        er.Robot.load(broken)
    assert found.value.line == 3 and found.value.file == str(broken) and found.value.message in str(found.value)


def test_a_pickle_is_the_file_and_notices_a_change(rx60b: Path, tmp_path: Path) -> None:
    robot = er.Robot.load(rx60b)
    again = pickle.loads(pickle.dumps(robot))
    q = states(robot, 5)
    assert (robot.fk(q) == again.fk(q)).all()
    copy = tmp_path / "arm.urdf"
    copy.write_text("<robot name='a'><link name='l'/></robot>")
    kept = pickle.dumps(er.Robot.load(copy))
    copy.write_text("<robot name='a'><link name='other'/></robot>")
    with pytest.raises(er.FileError, match="has changed since"):
        pickle.loads(kept)
    copy.unlink()
    with pytest.raises(er.FileError, match="cannot be read"):
        pickle.loads(kept)
