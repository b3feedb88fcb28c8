"""Random calls with random arguments: an answer or an exception that says why, and never a crash.

ELBOWROOM_RANDOM_CALLS sets how many; `docs/measurements/python.md` says what was tried.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import elbowroom as er
from conftest import ROOT

CALLS = int(os.environ.get("ELBOWROOM_RANDOM_CALLS", "500"))

#: What a call may raise: exceptions of the package, and those of Python for arguments of a wrong type or size, or of a wrong number.
EXPECTED = (er.Error, TypeError, OverflowError)


def number(rng: random.Random) -> Any:
    """A number, often an odd one."""
    odd = [0.0, -0.0, 1e-320, 1e300, -1e300, float("nan"), float("inf"), -float("inf"), 2**63, -(2**70), True, np.float32(0.1), np.int8(3)]
    return rng.choice(odd) if rng.random() < 0.4 else rng.uniform(-3, 3)


def array(rng: random.Random, width: int) -> Any:
    """An array of states, often of another shape, type or layout."""
    rows = rng.choice([0, 1, 1, 2, 5])
    columns = width if rng.random() < 0.7 else rng.choice([0, 1, 3, 7, width + 1])
    values = np.random.default_rng(rng.randrange(2**32)).uniform(-2, 2, (rows, columns))
    if rng.random() < 0.2 and values.size:
        values[rng.randrange(rows), rng.randrange(columns)] = rng.choice([np.nan, np.inf, 1e300, -1e308])
    changes: list[Callable[[Any], Any]] = [
        lambda v: v,
        lambda v: v,
        np.asfortranarray,
        lambda v: np.repeat(v, 2, axis=0)[::2],
        lambda v: v[::-1, ::-1],
        lambda v: v.astype(np.float32),
        lambda v: v.astype(">f8"),
        lambda v: v.astype(complex),
        lambda v: v.astype(object),
        lambda v: v.ravel(),
        lambda v: v[None],
        lambda v: v.tolist(),
        lambda v: np.ma.masked_array(v),
    ]
    with np.errstate(all="ignore"):
        found = rng.choice(changes)(values)
    if isinstance(found, np.ndarray) and rng.random() < 0.3:
        found.flags.writeable = False
    return found


def pose(rng: random.Random) -> Any:
    """A pose, often none."""
    good = [np.eye(4), ([0.4, 0.1, 0.3], [0, 0, 0, 1]), ((0.5, 0, 0.2), (1, 0, 0, 0))]
    odd = [np.eye(3), np.full((4, 4), np.nan), ([0, 0], [0, 0, 0, 1]), ([0, 0, 0], [0, 0, 0, 0]), "pose", np.zeros((4, 4)), ([1e300] * 3, [0, 0, 0, 1])]
    return rng.choice(good if rng.random() < 0.6 else odd)


def anything(rng: random.Random, width: int) -> Any:
    """Any argument."""
    kinds: list[Callable[[], Any]] = [
        lambda: number(rng),
        lambda: array(rng, width),
        lambda: pose(rng),
        lambda: rng.choice([None, "", "arm", "left", "exact", "table", "\0", "ü" * 300, b"bytes", object(), [], {}, (), [1, "a"], {"a": 1}]),
        lambda: [number(rng) for _ in range(width)],
    ]
    return rng.choice(kinds)()


def methods(source: Any) -> list[tuple[Callable[..., Any], list[str]]]:
    """The methods of an object that write no file and open no browser, with the keywords that they know."""
    keywords = {
        "plan": ["pose", "linear", "objects", "speed", "seed", "optimize", "period_s"],
        "tick": ["qd", "intent", "programmed_override"],
        "evaluate": ["qd", "intent", "programmed_override", "base"],
        "map": ["model"],
        "jacobian": ["link", "point"],
        "fk": ["link"],
        "ik": ["link"],
        "step": ["speed_override"],
        "follow": ["speed_override"],
        "moved": ["spheres"],
        "go_on": ["speed_override"],
        "to_trimesh": ["kind"],
        "to_rerun": ["motions"],
    }
    left_out = {"page", "save", "run", "report", "load", "time_optimal"}
    names = [name for name in dir(source) if not name.startswith("_") and name not in left_out]
    return [(getattr(source, name), keywords.get(name, [])) for name in names if callable(getattr(source, name))]


def usual(rng: random.Random, name: str, width: int) -> list[Any]:
    """Arguments with which a method answers, mostly."""
    rows = rng.choice([0, 1, 3])
    q = np.random.default_rng(rng.randrange(2**32)).uniform(-1, 1, (rows, width))
    row, there = [rng.uniform(-1, 1) for _ in range(width)], ([0.4, 0.1, 0.3], [0, 0, 0, 1])
    known: dict[str, list[Any]] = {
        "within": [q, rng.uniform(0, 1)],
        "edges": [q, -q],
        "ik": [there],
        "plan": [row, row],
        "tick": [rng.uniform(0, 9), row],
        "evaluate": [np.sort(np.arange(rows, dtype=float)), q] if width == 12 else [q],
        "moved": [{"pallet": there}],
        "step": [there],
        "follow": [np.tile([0.0, 0.0, 0.45, 0.0, 0.0, 0.0, 1.0], (rows, 1))],
        "switch": ["table", True],
        "is_active": ["table"],
        "add": ["object", "thing"],
        "add_robot": ["arm", "arm.urdf"],
        "add_box": ["box", [1, 2, 3], there],
        "add_sphere": ["ball", 0.1, [0, 0, 1]],
        "add_cylinder": ["post", 0.1, 2.0, there],
        "add_capsule": ["pipe", 0.1, 2.0],
        "add_mesh": ["mesh", ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])],
        "move": ["box", there],
        "remove": ["box"],
        "correction": [rng.uniform(0, 2), row],
        "at": [rng.uniform(-1, 9)],
        "resampled": [rng.uniform(0, 1)],
        "go_on": [3],
    }
    if name in known:
        return known[name]
    return [q] if name in ("fk", "jacobian", "collides", "distance", "witness", "is_blocked") else []


def time_optimal(waypoints: Any, **keywords: Any) -> er.Trajectory:
    """The fastest motion along waypoints."""
    return er.Trajectory.time_optimal(waypoints, velocity=1.0, acceleration=2.0, jerk=30.0, **keywords)


def test_random_calls_answer_or_say_why(rx60b: Path, exchange: Path) -> None:
    robot, cell = er.Robot.load(rx60b), er.Cell.load(exchange)
    sources: list[tuple[Any, int]] = [
        (robot, robot.dof),
        (cell, 6),
        (er.Checker(robot), robot.dof),
        (er.Checker(cell), 12),
        (er.Monitor(cell), 12),
        (er.GuidedArm(er.Cell.load(ROOT / "examples/guided/cell.toml")), 7),
        (er.Planner(cell, "left"), 6),
        (er.ReachQuery(cell, "left"), 7),
        (cell.map("left"), 3),
        (er.Scene(), 3),
        (er.Rules(), 4),
        (er.Trajectory([0.0, 1.0], [[0.0] * 6, [1.0] * 6]), 6),
        (er.VirtualRobot(er.Cell.load(ROOT / "examples/inspection/cell.toml")), 18),
    ]
    makers: list[Callable[..., Any]] = [er.Robot.load, er.Cell.load, er.Checker, er.GuidedArm, er.Monitor, er.Planner, er.ReachQuery, er.Scene]
    makers += [er.Robot.of, er.Rules, er.Trajectory, er.VirtualRobot, time_optimal]
    answered = 0
    seed = random.randrange(2**32) if CALLS > 1000 else 7
    rng = random.Random(seed)
    for call in range(CALLS):
        source, width = rng.choice(sources)
        function, keywords = rng.choice(methods(source))
        words = usual(rng, function.__name__, width)
        if rng.random() < 0.1:
            function = rng.choice(makers)
            keywords, words = ["blend", "period_s", "joints"] if function is time_optimal else [], [rng.choice([robot, cell, anything(rng, width)])]
        named = {name: anything(rng, width) for name in keywords if rng.random() < 0.1}
        for _ in range(rng.choice([0, 1, 1, 2])):
            words.insert(rng.randrange(len(words) + 1), anything(rng, width))
            if rng.random() < 0.8:
                words.pop(rng.randrange(len(words)))
        if function.__name__ == "plan":
            named["time_limit_s"] = 0.02
        try:
            function(*words, **named)
            answered += 1
        except EXPECTED as error:
            assert str(error), (seed, call, function)
        except BaseException as error:
            # NumPy refuses to make a number of an array; the note says of which argument.
            if isinstance(error, ValueError) and any("while processing" in note for note in getattr(error, "__notes__", [])):
                continue
            told = f"{function.__qualname__} of {words!r:.500} and {named!r:.300}: {type(error).__name__}: {error}"
            pytest.fail(f"seed {seed}, call {call}: {told}")
    assert answered > CALLS // 5, answered
