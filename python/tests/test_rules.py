"""The fuzzy rules of avoidance."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import elbowroom as er


def test_corrections_are_those_of_the_command(command: Path, tmp_path: Path) -> None:
    told = json.loads(subprocess.run([command, "rules", "--json"], check=True, capture_output=True).stdout)
    rules = er.Rules()
    surfaces = rules.surfaces(41)
    assert repr(rules) == f"Rules({told['rules']} rules)" and set(surfaces) == {s["output"] for s in told["surfaces"]}
    for surface in told["surfaces"]:
        distance, speed, values = surfaces[surface["output"]]
        assert distance.tolist() == surface["proximity_m"] and speed.tolist() == surface["speed_m_s"]
        assert values.tolist() == surface["values"]
    file = tmp_path / "rules.toml"
    subprocess.run([command, "rules", "--write", file], check=True, capture_output=True)
    assert er.Rules.load(file).text == rules.text == file.read_text()


def test_corrections_have_the_shape_of_the_arguments() -> None:
    rules = er.Rules()
    distance, speed = np.linspace(0.0, 1.0, 60), np.linspace(-0.2, 1.5, 25)[:, None]
    size, direction = rules.correction(distance, speed)
    assert size.shape == direction.shape == (25, 60)
    assert 0.0 <= size.min() and size.max() <= 1.0 and 0.0 <= direction.min() and direction.max() <= np.pi / 2
    # Contact is evaded more than anything beyond the reach.
    far = rules.correction(np.linspace(rules.reach_m, 9.0, 5), speed)[0]
    assert (size[:, :1] >= far).all()
    # What goes away is as what stands.
    assert (size[speed[:, 0] < 0.0] == rules.correction(distance, 0.0)[0]).all()
    one, turn = rules.correction(0.05, 0.3)
    assert one.shape == turn.shape == () and one > 0.8
    copied = pickle.loads(pickle.dumps(rules))
    assert (copied.correction(distance, speed)[0] == size).all()


def test_what_is_no_rules_teaches(tmp_path: Path) -> None:
    file = tmp_path / "rules.toml"
    file.write_text("[input.proximity]\nrange = 5\n")
    with pytest.raises(er.FileError, match=r"rules.toml:2: .*\n  write: range"):
        er.Rules.load(file)
    with pytest.raises(er.FileError, match="cannot be read"):
        er.Rules.load(tmp_path / "none.toml")
    with pytest.raises(er.ArgumentError, match="write: "):
        er.Rules("[input]")
    for wrong in ([1.0, np.nan], "near", 1j, [[1.0], [2.0, 3.0]]):
        with pytest.raises(er.ArrayError):
            er.Rules().correction(wrong, 0.0)
    for steps in (1, -1, 10**6):
        with pytest.raises(er.ArgumentError, match="`steps`"):
            er.Rules().surfaces(steps)
