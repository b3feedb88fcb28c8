"""Sweeps: the answers of a checker, however they are cut, interrupted, or spread over a cluster."""

from __future__ import annotations

import functools
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elbowroom as er
from conftest import ROOT
from elbowroom import sweep
from elbowroom.poses import matrix as elbowroom_matrix
from elbowroom.sweep import driver
from elbowroom.sweep.functions import name_of
from elbowroom.sweep.shard import Job, compute
from elbowroom.sweep.states import Grid, Random, Sobol, States, Table

RX60B = ROOT / "examples/models/rx60b/rx60b.urdf"
LIMITS = np.array([[-1.0, 2.0], [-np.inf, np.inf], [0.0, 0.5]])


def task(out: Path, states: States, **others: Any) -> sweep.Task:
    return sweep.Task(RX60B, states, out, **{"is_cell": False, "shard_rows": 200} | others)


def columns(result: sweep.Result) -> dict[str, npt.NDArray[Any]]:
    parts = list(result.batches())
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@given(st.integers(0, 500), st.integers(1, 200), st.sampled_from(["random", "sobol", "grid"]))
@settings(max_examples=60, deadline=None)
def test_a_part_of_the_states_is_the_same_alone(first: int, count: int, kind: str) -> None:
    states: States = {"random": Random(700, 3), "sobol": Sobol(700, 3), "grid": Grid((10, 7, 10))}[kind]
    assert states.count(LIMITS) == 700
    whole = states.rows(0, 700, LIMITS)
    assert whole.flags.c_contiguous and whole.shape == (700, 3)
    assert (states.rows(first, count, LIMITS)[: 700 - first] == whole[first : first + count]).all()
    assert (whole[:, 0] >= -1).all() and (whole[:, 0] <= 2).all() and (np.abs(whole[:, 1]) <= np.pi).all()


def test_a_grid_has_every_combination_and_a_single_value_is_the_middle() -> None:
    rows = Grid((3, 1, 2)).rows(0, 6, LIMITS)
    assert rows.tolist() == [[a, 0.0, c] for a in (-1.0, 0.5, 2.0) for c in (0.0, 0.5)]
    with pytest.raises(er.ArgumentError, match="one number for each joint"):
        Grid((3, 3)).count(LIMITS)


def test_the_answers_are_those_of_the_checker(tmp_path: Path) -> None:
    asked = task(tmp_path / "out", Random(1100, 5))
    result = sweep.run(asked)
    found = columns(result)
    checker = er.Checker(er.Robot.load(RX60B))
    q = Random(1100, 5).rows(0, 1100, checker.limits)
    expected = checker.witness(q)
    assert (found["index"] == np.arange(1100)).all()
    assert (found["collides"] == checker.collides(q)).all() and result.counts["collides"] == found["collides"].sum() > 50
    assert (found["distance_m"] <= expected.distance_m).all()
    assert np.allclose(found["distance_m"], expected.distance_m, rtol=2e-7, atol=0)
    assert found["a"].tolist() == expected.a and found["b"].tolist() == expected.b
    # The same from the manifest, and again without work; a collision alone has the same states.
    before = {file: file.stat().st_mtime_ns for file in result.folder.glob("part-*")}
    assert sweep.Result.load(result.folder) == sweep.run(asked) == result
    assert {file: file.stat().st_mtime_ns for file in result.folder.glob("part-*")} == before
    alone = sweep.run(replace(asked, ask="collision", out=tmp_path / "collision", shard_rows=333))
    assert (columns(alone)["collides"] == found["collides"]).all() and set(columns(alone)) == {"index", "collides"}


def turned_and_squared(checker: er.Checker, q: npt.NDArray[np.float64]) -> dict[str, Any]:
    return {"free": ~checker.collides(q), "norm": np.sum(q * q, axis=1), "name": [f"{row[0]:.1f}" for row in q]}


def test_a_tolerance_and_a_function_of_ones_own(tmp_path: Path) -> None:
    checker = er.Checker(er.Robot.load(RX60B))
    q = Random(900, 5).rows(0, 900, checker.limits)
    near = sweep.run(task(tmp_path / "near", Random(900, 5), ask="tolerance", tolerance_m=0.05))
    assert (columns(near)["within"] == checker.within(q, 0.05)).all() and near.counts["within"] > 10
    own = sweep.run(task(tmp_path / "own", Random(900, 5), ask=turned_and_squared))
    found = columns(own)
    assert (found["free"] == ~checker.collides(q)).all() and own.counts["free"] == found["free"].sum()
    assert own.least["norm"] == np.sum(q * q, axis=1).min() and found["name"][3] == f"{q[3, 0]:.1f}"
    with pytest.raises(er.ArrayError, match=r"the column `a` has the shape \(3,\)"):
        sweep.run(task(tmp_path / "short", Random(900), ask=lambda _, q: {"a": [None] * 3}))
    with pytest.raises(er.ArgumentError, match="a dict of columns"):
        sweep.run(task(tmp_path / "none", Random(900), ask=lambda _, q: np.zeros(len(q))))
    wrong: list[tuple[Any, str]] = [
        (lambda _, q: {}, "a dict of columns"),
        (lambda _, q: {"a": 3.0}, r"the column `a` has the shape \(\)"),
        (lambda _, q: {"a": q}, "the column `a` has the shape"),
        (lambda _, q: {"a": q[:, 0].astype(complex)}, "has the type complex128"),
        (lambda _, q: {"a": [object()] * len(q)}, "has the type object"),
        (lambda _, q: {3: q[:, 0]}, "3 cannot name a column"),
        (lambda _, q: {"index": q[:, 0]}, "'index' cannot name"),
    ]
    for k, (function, message) in enumerate(wrong):
        with pytest.raises(er.Error, match=message):
            sweep.run(task(tmp_path / f"wrong {k}", Random(900), ask=function))


def scaled(factor: Any) -> Any:
    return lambda _, q: {"v": factor * q[:, 0]}


def test_functions_that_differ_are_two_tasks(tmp_path: Path) -> None:
    def partly(_: er.Checker, q: npt.NDArray[np.float64], factor: float) -> dict[str, Any]:
        return {"v": factor * q[:, 0]}

    pairs: list[tuple[Any, Any]] = [
        (scaled(1.0), scaled(2.0)),
        (lambda _, q: {"v": q[:, 0]}, lambda _, q: {"v": q[:, 1]}),
        (lambda _, q: {"v": q[:, 0] + 1.0}, lambda _, q: {"v": q[:, 0] + 2.0}),
        (functools.partial(partly, factor=1.0), functools.partial(partly, factor=2.0)),
        (scaled(np.arange(6.0)), scaled(np.arange(6.0) + 1)),
    ]
    for one, other in pairs:
        assert name_of(one) != name_of(other)
    assert name_of(scaled(1.0)) == name_of(scaled(1.0))
    with pytest.raises(er.ArgumentError, match="nothing tells"):
        name_of(scaled(object()))
    sweep.run(task(tmp_path, Random(300), ask=scaled(1.0)))
    with pytest.raises(er.Error, match="not a part of this sweep"):
        sweep.run(task(tmp_path, Random(300), ask=scaled(2.0)))


def placements(folder: Path, cell: Path, **others: Any) -> sweep.Task:
    rng = np.random.default_rng(4)
    points = rng.uniform([-0.4, -0.25, 0.42], [0.4, 0.25, 0.6], (30, 3))
    np.save(folder / "spots.npy", np.hstack([points, np.tile([0.0, 0.0, -1.0], (30, 1))]))
    bases = sweep.BaseGrid(x_m=(-1.0, 0.6, 3), y_m=(-1.3, -0.9, 2), yaw_rad=(0.0, np.pi, 3))
    rows = sweep.Placements(bases, folder / "spots.npy", "left", turns=4)
    return sweep.Task(cell, rows, folder / "out", **{"shard_rows": 47} | others)


def test_places_of_a_base_are_compared(tmp_path: Path, exchange: Path) -> None:
    asked = placements(tmp_path, exchange)
    result = sweep.run(asked)
    query, targets = er.ReachQuery(er.Cell.load(exchange), "left", turns=4), np.load(tmp_path / "spots.npy")
    found, placement = columns(result), result.placement()
    assert result.rows == 18 * 30 and len(placement.bases) == 18 and placement.targets == 30
    for place in range(18):
        base = (placement.bases[place, :3], placement.bases[place, 3:])
        direct = query.evaluate(targets, base)
        rows = slice(30 * place, 30 * place + 30)
        assert (found["free"][rows] == direct.free).all() and (found["solutions"][rows] == direct.solutions).all()
        counts = [placement.in_reach[place], placement.reached[place], placement.states[place]]
        assert counts == [(direct.solutions > 0).sum(), (direct.free > 0).sum(), direct.free.sum()]
    assert placement.reached[placement.best(1)[0]] == placement.reached.max() > placement.reached.min()
    # Cut in another way, and places from a table.
    np.save(tmp_path / "bases.npy", placement.bases)
    table = replace(placements(tmp_path, exchange), out=tmp_path / "table", shard_rows=500)
    places = sweep.Placements(sweep.BaseTable(tmp_path / "bases.npy"), tmp_path / "spots.npy", "left", turns=4)
    table = replace(table, states=places)
    assert (columns(sweep.run(table))["free"] == found["free"]).all()


def test_a_cell_that_has_changed_and_parts_that_are_gone_are_told(tmp_path: Path, exchange: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(exchange.read_text().replace("../models", str(exchange.parent.parent / "models")))
    asked = placements(tmp_path, cell)
    result = sweep.run(asked)
    (result.folder / "part-000003.parquet").rename(tmp_path / "gone")
    with pytest.raises(er.FileError, match=r"part-000003.parquet: .*\n  write: remove the part, and run the sweep again"):
        result.placement()
    (tmp_path / "gone").rename(result.folder / "part-000003.parquet")
    cell.write_text(cell.read_text() + '[object.block]\nshape = "box"\nat = [0, 0, 900]\nsize = [100, 100, 100]\n')
    with pytest.raises(er.Error, match="not a part of this sweep"):
        sweep.run(asked)


def test_rows_that_are_no_targets_or_places_are_told_before_anything_is_computed(tmp_path: Path, exchange: Path) -> None:
    asked = placements(tmp_path, exchange)
    spots = np.load(tmp_path / "spots.npy")
    spots[21, 3:] = 0.0
    np.save(tmp_path / "spots.npy", spots)
    with pytest.raises(er.ArrayError, match="spots.npy: row 21 has a direction of length 0"):
        sweep.run(asked)
    np.save(tmp_path / "bases.npy", np.array([[0, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 0]], dtype=float))
    rows = sweep.Placements(sweep.BaseTable(tmp_path / "bases.npy"), str(tmp_path / "bases.npy"), "left")
    with pytest.raises(er.ArrayError, match="bases.npy: row 1 has a quaternion of length 0"):
        sweep.run(sweep.Task(exchange, rows, tmp_path / "out2"))
    with pytest.raises(er.ArgumentError, match="`between`, `level` and `tolerance_m` do not fit"):
        placements(tmp_path, exchange, between="left,pallet")


def test_a_base_that_turns_keeps_its_place_in_a_table() -> None:
    present = np.eye(4)
    present[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    grid = sweep.BaseGrid(x_m=(0.0, 1.0, 2), z_m=(0.5, 0.5, 1), yaw_rad=(-3.0, 3.0, 7))
    for number, row in enumerate(grid.table(present)):
        x, y, z, w = row[3:]
        turn = np.array(elbowroom_matrix((row[:3], (x, y, z, w))))
        assert np.allclose(turn, grid.pose(number, present), atol=1e-12)
    assert grid.count() == 14 and grid.pose(13, present)[:3, 3].tolist() == [1.0, 0.0, 0.5]


def test_pictures_show_states_and_places(tmp_path: Path, exchange: Path) -> None:
    pytest.importorskip("matplotlib", reason="skipped: no matplotlib")
    grid = sweep.run(task(tmp_path / "grid", Grid((1, 9, 7, 1, 2, 1))))
    figure = grid.picture(tmp_path / "grid.png", axes=(er.Robot.load(RX60B).joints[1], er.Robot.load(RX60B).joints[2]))
    image = figure.axes[0].get_images()[0].get_array()
    distances = columns(grid)["distance_m"].reshape(9, 7, 2).astype(float).mean(axis=2)
    assert image is not None and np.allclose(image, 1e3 * distances.T)
    assert (tmp_path / "grid.png").stat().st_size > 5000
    assert sweep.run(task(tmp_path / "sobol", Sobol(2000), ask="collision")).picture().axes
    with pytest.raises(er.ArgumentError, match="there is no joint 'x'"):
        grid.picture(axes=("x", "y"))
    places = sweep.run(placements(tmp_path, exchange))
    shares = places.picture(tmp_path / "places.svg").axes[0].collections[0].get_array()
    assert shares is not None and shares.max() == pytest.approx(100 * places.placement().reached.max() / 30)
    with pytest.raises(er.ArgumentError, match="no places of a base"):
        grid.placement()


def test_a_table_of_states_and_a_cell(tmp_path: Path, exchange: Path) -> None:
    checker = er.Checker(er.Cell.load(exchange))
    q = np.random.default_rng(2).uniform(-2, 2, (450, len(checker.joints)))
    np.save(tmp_path / "q.npy", q)
    asked = sweep.Task(exchange, Table(tmp_path / "q.npy"), tmp_path / "out", shard_rows=200)
    assert (columns(sweep.run(asked))["collides"] == checker.collides(q)).all()
    np.save(tmp_path / "q.npy", q[:, :2])
    with pytest.raises(er.ArrayError, match="2 columns"):
        sweep.run(asked, out=tmp_path / "other")


def started(file: Path, *words: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "elbowroom.sweep", str(file), *words]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def wait_for_parts(folder: Path, count: int, longest_s: float = 60.0) -> None:
    begun = time.monotonic()
    while len(list(folder.glob("part-*.parquet"))) < count:
        assert time.monotonic() - begun < longest_s, "no parts"
        time.sleep(0.005)


def written(folder: Path, rows: int) -> Path:
    file = folder / "big.toml"
    file.write_text(f'robot = "{RX60B}"\nshard_rows = 300\n[states]\nkind = "sobol"\nrows = {rows}\n')
    return file


def test_a_driver_that_was_killed_goes_on(tmp_path: Path) -> None:
    file = written(tmp_path, 12_000)
    expected = sweep.run(sweep.Task.load(file), out=tmp_path / "whole")
    out = tmp_path / "big-sweep"
    for parts in (3, 8):
        process = started(file)
        wait_for_parts(out, parts)
        process.kill()
        process.wait()
    (out / "part-000039.parquet.123.tmp").write_bytes(b"half a part")
    finished = {file: file.stat().st_mtime_ns for file in out.glob("part-*.parquet")}
    assert 8 <= len(finished) < 40 and not (out / "manifest.json").exists()
    assert sweep.run(sweep.Task.load(file)).sha256 == expected.sha256
    assert all(file.stat().st_mtime_ns == then for file, then in finished.items()), "nothing is computed twice"
    assert len(list(out.glob("part-*"))) == 40


def test_two_drivers_do_not_share_a_folder(tmp_path: Path) -> None:
    asked = task(tmp_path, Random(300))
    with driver._alone(tmp_path), pytest.raises(er.Error, match="another sweep is writing there"):
        sweep.run(asked)
    assert sweep.run(asked).rows == 300


def test_another_task_is_refused_and_a_damaged_or_misplaced_part_too(tmp_path: Path) -> None:
    asked = task(tmp_path, Random(500))
    sweep.run(asked)
    with pytest.raises(er.Error, match="not a part of this sweep"):
        sweep.run(replace(asked, states=Random(500, 2)))
    # What it says is true of finished sweeps only.
    with pytest.raises(er.FileError, match="a finished sweep"):
        sweep.Result.load(tmp_path)
    first, second, copy = (tmp_path / f"part-{name}.parquet" for name in ("000000", "000001", "000000-copy"))
    content = second.read_bytes()
    for file in (second, copy):
        file.write_bytes(first.read_bytes())
        with pytest.raises(er.Error, match=f"{file.name}: is not a part of this sweep"):
            sweep.run(asked)
        file.unlink()
    second.write_bytes(content[:-9])
    with pytest.raises(er.Error, match="part-000001.parquet: is not a part"):
        sweep.run(asked)
    second.unlink()
    assert sweep.run(asked).rows == 500


def test_a_model_that_has_changed_is_another(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(RX60B.read_text().replace("meshes/", f"{RX60B.parent}/meshes/"))
    asked = replace(task(tmp_path / "out", Random(300)), model=tmp_path / "arm.urdf")
    sweep.run(asked)
    moved = re.sub(r'xyz="0 0 ([0-9.]+)"', lambda found: f'xyz="0.001 0 {found[1]}"', (tmp_path / "arm.urdf").read_text())
    (tmp_path / "arm.urdf").write_text(moved)
    with pytest.raises(er.Error, match="not a part of this sweep"):
        sweep.run(asked)
    # A worker with other files refuses.
    job = Job(asked, "another", "fingerprint of the driver", tmp_path / "out", 300)
    with pytest.raises(er.Error, match="another model than that of the driver"):
        compute(job, 0)


def test_folders_and_files_that_cannot_be_used_are_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(er.Error, match="cannot be written to"):
            sweep.run(task(out, Random(10)))
    with pytest.raises(er.FileError, match="no.urdf"):
        sweep.run(replace(task(tmp_path / "out", Random(10)), model=tmp_path / "no.urdf"))
    q = np.zeros((300, 6))
    q[233, 2] = np.nan
    np.save(tmp_path / "q.npy", q)
    with pytest.raises(er.ArrayError, match="q.npy: row 233"):
        sweep.run(task(tmp_path / "nan", Table(tmp_path / "q.npy")))
    np.savez(tmp_path / "q.npz", q=q)
    (tmp_path / "empty.npy").write_bytes(b"")
    for name in ("q.npz", "empty.npy", "none.npy"):
        with pytest.raises(er.FileError, match=f"{name}: cannot be read"):
            sweep.run(task(tmp_path / "table", Table(tmp_path / name)))
    for states in (lambda: Random(-5), lambda: Sobol(3, 2**70)):
        with pytest.raises(er.ArgumentError, match="whole numbers"):
            states()
    with pytest.raises(er.ArgumentError, match="fewer values"):
        sweep.run(task(tmp_path / "grid", Grid((2**30,) * 6)))


def test_an_interrupted_command_says_how_it_goes_on(tmp_path: Path) -> None:
    file = written(tmp_path, 400_000)
    command = [sys.executable, "-m", "elbowroom.sweep", str(file)]
    # A shell lets its background processes ignore the signal, and they pass that on.
    heeded = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=heeded)
    wait_for_parts(tmp_path / "big-sweep", 1)
    process.send_signal(signal.SIGINT)
    told = process.communicate(timeout=30)[1]
    assert process.returncode == 130 and "goes on where it was" in told and "Traceback" not in told, told


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the model is missing"),
        ('cell = "a"\nrobot = "b"', "there are two"),
        ('cell = "a"', r"write: \[states\]"),
        ('cell = "a"\n[reach]\ntargets = "t"', "the states are missing"),
        ('cell = "a"\n[reach]\nturns = 2\n[bases]\nkind = "grid"', "`targets` is missing"),
        ('cell = "a"\n[reach]\ntargets = "t"\n[bases]\nkind = "ring"', "one of grid, table"),
        ('cell = "a"\n[reach]\ntargets = "t"\n[bases]\nkind = "grid"\nx_m = [0, 1]', "first value, last value and how many"),
        ('cell = "a"\n[reach]\ntargets = "t"\n[bases]\nkind = "grid"\nx = [0, 1, 2]', "`x` is not a key of these bases"),
        ('cell = "a"\nask = "distance"\n[reach]\ntargets = "t"\n[bases]\nkind = "grid"', "`ask` does not fit"),
        ('cell = "a"\nask = "reach"\n[states]\nkind = "random"\nrows = 1', "`ask` does not fit"),
        ('cell = "a"\ntolerance_m = -1\n[states]\nkind = "random"\nrows = 1', "`tolerance_m` is -1"),
        ('cell = "a"\nshard_row = 1\n[states]\nkind = "random"', "`shard_row` is not a key of a task"),
        ('cell = "a"\n[states]\nkind = "rand"', "one of random, sobol, grid, table"),
        ('cell = "a"\n[states]\nkind = "random"\nrows = -1', "`rows` is -1"),
        ('cell = "a"\n[states]\nkind = "random"\nrow = 1', "`row` is not a key"),
        ('cell = "a"\nsrdf = "b"\n[states]\nkind = "random"\nrows = 1', "`srdf` belongs to a robot"),
        ('cell = "a"\n[states]\nkind = "table"', "`file` is missing"),
        ('cell = "a"\n[states]\nkind = "grid"\nsteps = [true]', "one whole number for each joint"),
        ('cell = "a"\n[states]\nkind = "grid"\nsteps = [1, 0]', "one whole number for each joint"),
        ('cell = "a"\nask = "time"\n[states]\nkind = "random"\nrows = 1', "`ask` is 'time'"),
        ('cell = "a"\nshard_rows = 0\n[states]\nkind = "random"\nrows = 1', "`shard_rows` is 0"),
        ("cell = ", "TOML"),
    ],
)
def test_wrong_tasks_are_told_what_to_write(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "task.toml"
    file.write_text(text)
    with pytest.raises(er.FileError, match=message) as told:
        sweep.Task.load(file)
    assert str(told.value).startswith(f"{file}: ") and told.value.hint


def test_the_command_hands_over(command: Path, tmp_path: Path) -> None:
    file = written(tmp_path, 700)
    env = os.environ | {"ELBOWROOM_PYTHON": sys.executable}
    run = subprocess.run([command, "sweep", file, "--out", tmp_path / "out"], env=env, capture_output=True, text=True)
    assert run.returncode == 0 and "700 rows" in run.stdout, run.stderr
    assert sweep.Result.load(tmp_path / "out").sha256 in run.stdout
    file.write_text("cell = 1\n[states]")
    run = subprocess.run([command, "sweep", file], env=env, capture_output=True, text=True)
    assert run.returncode == 2 and "a text in quotation marks" in run.stderr, run.stderr
    nobody = env | {"ELBOWROOM_PYTHON": str(tmp_path / "python")}
    run = subprocess.run([command, "sweep", file], env=nobody, capture_output=True, text=True)
    assert run.returncode == 2 and "pip install 'elbowroom[sweep]'" in run.stderr, run.stderr


@pytest.fixture
def cluster() -> Iterator[Any]:
    """A machine of one processor, simulated on this one; tests add others."""
    cluster_utils = pytest.importorskip("ray.cluster_utils", reason="skipped: no Ray")
    ray = sys.modules["ray"]
    found = cluster_utils.Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "object_store_memory": 2 * 10**8})
    ray.init(address=found.address, log_to_driver=False, configure_logging=False)
    yield found
    ray.shutdown()
    found.shutdown()


def kill_a_worker() -> bool:
    """Kill a process that computes a shard."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            name = (process / "cmdline").read_bytes()
        except OSError:
            continue
        if name.startswith(b"ray::compute"):
            os.kill(int(process.name), signal.SIGKILL)
            return True
    return False


def test_workers_and_machines_that_die_lose_nothing(tmp_path: Path, cluster: Any) -> None:
    machine = cluster.add_node(num_cpus=1, object_store_memory=2 * 10**8)
    asked = task(tmp_path / "ray", Sobol(8_000), shard_rows=250)
    expected = sweep.run(asked, out=tmp_path / "local")
    killed = 0

    def kill() -> None:
        nonlocal killed
        for parts in (2, 8):
            wait_for_parts(tmp_path / "ray", parts)
            killed += kill_a_worker()
        cluster.remove_node(machine, allow_graceful=False)

    killer = threading.Thread(target=kill)
    killer.start()
    result = sweep.run(asked, executor="ray")
    killer.join()
    assert result.sha256 == expected.sha256 and result.rows == 8_000 and killed > 0
    assert result.counts == expected.counts
