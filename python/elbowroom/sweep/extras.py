"""Libraries that only sweeps need: imported when they are used."""

from __future__ import annotations

import importlib
from typing import Any

from elbowroom.errors import Error


def imported(module: str, package: str) -> Any:
    """Import a module, or say which package has it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        text = f"{package} is not installed: {error}\n  write: pip install 'elbowroom[sweep]'"
        raise Error(text) from error
