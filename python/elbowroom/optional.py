"""Packages that are not required."""

from __future__ import annotations

import importlib
from typing import Any

from elbowroom.errors import ArgumentError

__all__ = ["imported"]


def imported(name: str) -> Any:
    """Import a package that is not required."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = {"rerun": "rerun-sdk"}.get(name, name)
        raise ArgumentError(f"this needs the package {package}\n  write: pip install {package}") from error
