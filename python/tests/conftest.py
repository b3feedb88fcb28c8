"""Models and folders of the tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def rx60b() -> Path:
    """The example robot."""
    return ROOT / "examples/models/rx60b/rx60b.urdf"


@pytest.fixture
def exchange() -> Path:
    """A cell of two robots with objects and regions."""
    return ROOT / "examples/exchange/cell.toml"


@pytest.fixture
def command() -> Path:
    """The command, to compare with."""
    name = os.environ.get("ELBOWROOM_COMMAND")
    if name is None:
        pytest.skip("skipped: no ELBOWROOM_COMMAND")
    return Path(name)
