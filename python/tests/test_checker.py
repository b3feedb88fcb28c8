"""Collisions and distances: the rows of the command, and what is no array of states."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elbowroom as er
from conftest import ROOT

RX60B = ROOT / "examples/models/rx60b/rx60b.urdf"
ROBOT = er.Robot.load(RX60B)
CHECKER = er.Checker(ROBOT)


def states(columns: int, count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2.5, 2.5, (count, columns))


def rows_of(command: Path, args: list[str], checker: er.Checker, q: np.ndarray, folder: Path) -> list[list[str]]:
    """The rows that the command prints for the same states."""
    table = folder / "q.csv"
    lines = [",".join(checker.joints)] + [",".join(repr(float(v)) for v in row) for row in q]
    table.write_text("\n".join(lines))
    run = subprocess.run([command, "query", *args, "--states", table], capture_output=True, text=True)
    assert run.returncode in (0, 1), run.stderr
    return [line.split(",") for line in run.stdout.splitlines()[1:]]


@pytest.mark.parametrize("cell", [False, True])
def test_the_answers_are_those_of_the_command_to_the_bit(
    command: Path, exchange: Path, tmp_path: Path, cell: bool
) -> None:
    checker = er.Checker(er.Cell.load(exchange)) if cell else CHECKER
    model = [str(exchange)] if cell else ["--urdf", str(RX60B)]
    # From 1000 states on, the command proves pairs out of reach, as the package does: of equally near pairs both name the same.
    q = states(len(checker.joints), 1030 if cell else 3000)
    found = checker.witness(q)
    rows = rows_of(command, [*model, "--ask", "distance"], checker, q, tmp_path)
    assert len(rows) == len(q)
    for i, row in enumerate(rows):
        _, collides, distance, a, b, *numbers = row
        assert (float(distance), a, b) == (found.distance_m[i], found.a[i], found.b[i])
        assert (collides == "1") == (found.distance_m[i] == 0.0)
        assert [float(v) for v in numbers[:6]] == [*found.point_a_m[i], *found.point_b_m[i]]
    assert (checker.distance(q) == found.distance_m).all()
    rows = rows_of(command, [*model, "--ask", "collision"], checker, q, tmp_path)
    assert [row[1] == "1" for row in rows] == checker.collides(q).tolist()
    rows = rows_of(command, [*model, "--ask", "tolerance=0.05"], checker, q, tmp_path)
    assert [row[1] == "1" for row in rows] == checker.within(q, 0.05).tolist()


@given(st.integers(0, 2**32), st.floats(0.0, 0.5))
@settings(max_examples=40, deadline=None)
def test_collision_distance_and_tolerance_agree(seed: int, tolerance: float) -> None:
    q = states(6, 20, seed)
    distance = CHECKER.distance(q)
    assert (distance >= 0.0).all()
    assert ((distance == 0.0) == CHECKER.collides(q)).all()
    assert ((distance <= tolerance) == CHECKER.within(q, tolerance)).all()
    found = CHECKER.witness(q)
    # The points on nearly parallel faces are in the middle: farther apart than the distance by at most 1e-8 of the sizes.
    apart = np.linalg.norm(found.point_a_m - found.point_b_m, axis=1)
    assert np.abs(apart - found.distance_m)[found.distance_m > 0].max(initial=0.0) < 1e-8


def test_the_number_of_threads_changes_nothing() -> None:
    q = states(6, 1500)
    alone = er.Checker(ROBOT, threads=1)
    assert (alone.distance(q) == CHECKER.distance(q)).all()
    assert (pickle.loads(pickle.dumps(alone)).collides(q) == CHECKER.collides(q)).all()
    assert (CHECKER.limits == ROBOT.limits).all()
    with pytest.raises(ValueError):
        er.Checker(ROBOT, threads=0)


def test_strides_and_read_only_arrays_do_not_matter() -> None:
    q = states(6, 400)
    expected = CHECKER.distance(q)
    wide = np.zeros((400, 12))
    wide[:, ::2] = q
    read_only = q.copy()
    read_only.flags.writeable = False
    for same in (np.asfortranarray(q), wide[:, ::2], read_only, q[::-1][::-1]):
        assert (CHECKER.distance(same) == expected).all()
    assert (CHECKER.distance(q[::3]) == expected[::3]).all()
    assert CHECKER.distance(q[:0]).shape == (0,)


@pytest.mark.parametrize(
    ("q", "text"),
    [
        (np.zeros(6), r"shape \(6,\)"),
        (np.zeros((2, 5)), r"shape \(2, 5\)"),
        (np.zeros((1, 2, 6)), r"shape \(1, 2, 6\)"),
        (np.zeros((2, 6), dtype=np.float32), r"write: q.astype\(numpy.float64\)"),
        (np.zeros((2, 6), dtype=">f8"), "type >f8"),
        (np.zeros((2, 6), dtype=object), "type object"),
        ([[0.0] * 6], "no NumPy array"),
        (None, "no NumPy array"),
        (np.array([[0.0] * 6, [0.0, 0.0, np.nan, 0.0, 0.0, 0.0]]), "row 1, column 2 is NaN"),
        (np.array([[0.0] * 6, [0.0, 0.0, 0.0, 0.0, 0.0, -np.inf]]), "row 1, column 5 is -inf"),
    ],
)
def test_what_is_no_array_of_states_is_refused(q: Any, text: str) -> None:
    for call in (CHECKER.collides, CHECKER.distance, CHECKER.witness, ROBOT.fk):
        with pytest.raises(er.ArrayError, match=text):
            call(q)
    assert issubclass(er.ArrayError, ValueError) and issubclass(er.ArrayError, er.Error)


def test_a_row_beyond_the_first_chunk_is_named() -> None:
    q = np.zeros((70_000, 6))
    q[66_001, 4] = np.nan
    with pytest.raises(er.ArrayError, match="row 66001, column 4"):
        ROBOT.fk(q)


def test_words_and_numbers_that_are_not_possible_teach(exchange: Path) -> None:
    for tolerance in (-1.0, np.nan, np.inf):
        with pytest.raises(er.ArgumentError, match="finite number of metres"):
            CHECKER.within(np.zeros((1, 6)), tolerance)
    with pytest.raises(er.ArgumentError, match="`level`"):
        er.Checker(ROBOT, level="fine")
    with pytest.raises(er.ArgumentError, match="`between`"):
        er.Checker(er.Cell.load(exchange), between="left,nobody")
    with pytest.raises(er.ArgumentError, match=r"write: Checker\(Robot.load"):
        er.Checker("arm.urdf")  # type: ignore[arg-type]


def test_a_model_without_joints_has_no_states(tmp_path: Path) -> None:
    fixed = tmp_path / "fixed.urdf"
    fixed.write_text("<robot name='a'><link name='l'/></robot>")
    robot = er.Robot.load(fixed)
    assert robot.fk(np.zeros((3, 0))).shape == (3, 4, 4)
    with pytest.raises(er.ArgumentError, match="no joint that moves"):
        er.Checker(robot)


def test_levels_and_pairs_are_chosen(exchange: Path) -> None:
    q = states(6, 200)
    exact = CHECKER.distance(q)
    for level in ("L1", "L2", "L2:4", "capsule", "hull"):
        assert (er.Checker(ROBOT, level=level).distance(q) <= exact + 1e-9).all(), level
    cell = er.Cell.load(exchange)
    between = er.Checker(cell, between="left,right")
    q = states(len(between.joints), 40)
    assert (between.distance(q) >= er.Checker(cell).distance(q)).all()
    assert (between.distance(q) > er.Checker(cell).distance(q)).any()


def test_a_pickle_answers_alike(exchange: Path) -> None:
    checker = er.Checker(er.Cell.load(exchange), between="left,right", level="L2")
    again = pickle.loads(pickle.dumps(checker))
    q = states(len(checker.joints), 50)
    assert (checker.distance(q) == again.distance(q)).all()


def test_other_threads_run_meanwhile() -> None:
    q = states(6, 40_000)
    ticks = 0
    done = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(1e-3)

    counter = threading.Thread(target=count)
    counter.start()
    started = time.perf_counter()
    CHECKER.distance(q)
    took = time.perf_counter() - started
    done.set()
    counter.join()
    assert ticks > 0.05 * took / 1e-3, (ticks, took)


def test_ctrl_c_ends_a_long_call() -> None:
    script = (
        "import numpy as np, elbowroom as er, signal, time\n"
        f"checker = er.Checker(er.Robot.load({str(RX60B)!r}))\n"
        "q = np.random.default_rng(1).uniform(-2.5, 2.5, (1_000_000, 6))\n"
        # A process that is started in the background ignores the signal.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "print('go', flush=True)\n"
        "try:\n    checker.distance(q)\n    print('done')\n"
        "except KeyboardInterrupt:\n    print(time.time(), flush=True)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=os.environ)
    assert child.stdout is not None and child.stdout.readline() == "go\n"
    time.sleep(0.3)
    sent = time.time()
    child.send_signal(signal.SIGINT)
    ended = float(child.stdout.readline())
    assert child.wait() == 0
    assert ended - sent < 1.0, ended - sent


def test_motions_are_those_of_the_command_and_free_between_the_states(command: Path, exchange: Path, tmp_path: Path) -> None:
    checker = er.Checker(er.Cell.load(exchange), threads=2)
    # From 1000 states on, the command proves pairs out of reach, as the package does: the proofs end at the same shares.
    q = checker.start + 0.4 * states(len(checker.joints), 1002, seed=3)
    found = checker.edges(q[:-1], q[1:])
    rows = rows_of(command, [str(exchange), "--ask", "time"], checker, q, tmp_path)
    assert [float(row[2]) for row in rows] == found.free_share.tolist()
    assert [row[1] == "0" for row in rows] == found.free.tolist() and [row[-1] == "1" for row in rows] == found.certain.tolist()
    assert [row[3] or None for row in rows] == found.a and [row[4] or None for row in rows] == found.b
    assert 100 < found.free.sum() < 900
    # Nothing touches on what is free, and something does where the motion ends with certainty.
    share = np.linspace(0, 1, 40)[:, None]
    for i, (begin, end) in enumerate(zip(q[:60], q[1:61], strict=True)):
        steps = begin + (end - begin) * share * found.free_share[i] * (1 - 1e-9)
        assert not checker.collides(steps).any() or found.free_share[i] == 0.0
    assert checker.edges(q[:1], q[:1]).free.tolist() == [not checker.collides(q[:1])[0]]
    with pytest.raises(er.ArrayError, match="`q0` has 3 rows, `q1` 2"):
        checker.edges(q[:3], q[:2])
    with pytest.raises(er.ArrayError, match="`q1`: row 1"):
        checker.edges(q[:2], np.where([[False], [True]], np.nan, q[:2]))


def test_progress_is_told_on_standard_error(rx60b: Path, capsys: pytest.CaptureFixture[str]) -> None:
    checker = er.Checker(er.Robot.load(rx60b))
    q = np.tile(checker.start, (3000, 1))
    quiet = checker.distance(q)
    assert capsys.readouterr().err == ""
    assert (checker.distance(q, progress=True) == quiet).all()
    told = capsys.readouterr()
    assert "3,000 of 3,000 rows" in told.err and told.err.endswith("\n") and told.out == ""
    checker.edges(q[:300], q[:300], progress=True)
    assert "300 of 300 motions" in capsys.readouterr().err
    cell = er.Cell.load(ROOT / "examples/exchange/cell.toml")
    cell.map("left", progress=True)
    assert "objects" in capsys.readouterr().err
    er.ReachQuery(cell, "left").evaluate(np.array([[0.5, 0.1, 0.3, 0, 0, -1.0]]), progress=True)
    assert "1 of 1 targets" in capsys.readouterr().err
    monitor = er.Monitor(cell)
    monitor.evaluate(np.arange(300) * 0.002, np.zeros((300, 12)), progress=True)
    assert "300 of 300 ticks" in capsys.readouterr().err


@pytest.mark.parametrize("level", ["auto", "L2"])
def test_rows_that_are_asked_one_by_one_have_the_same_numbers(rx60b: Path, exchange: Path, level: str) -> None:
    for source in (er.Robot.load(rx60b), er.Cell.load(exchange)):
        checker = er.Checker(source, level=level)
        lower, upper = np.clip(checker.limits, -3, 3).T
        q = np.random.default_rng(3).uniform(lower, upper, (400, len(checker.joints)))
        collides, distance, within = checker.collides(q), checker.distance(q), checker.within(q, 0.05)
        assert 0 < collides.sum() < len(q)
        for few in (1, 3, 16):
            rows = np.random.default_rng(few).permutation(len(q))[: 200 // few * few].reshape(-1, few)
            for row in rows:
                assert (checker.distance(q[row]) == distance[row]).all()
                assert (checker.collides(q[row]) == collides[row]).all()
                assert (checker.within(q[row], 0.05) == within[row]).all()


def test_threads_that_ask_row_by_row_have_the_same_numbers(exchange: Path) -> None:
    checker = er.Checker(er.Cell.load(exchange))
    q = np.random.default_rng(4).uniform(-1, 1, (300, 12))
    expected = checker.distance(q)
    found = np.zeros((4, len(q)))

    def ask(number: int) -> None:
        for row in np.random.default_rng(number).permutation(len(q)):
            found[number, row] = checker.distance(q[row : row + 1])[0]

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (found == expected).all()
