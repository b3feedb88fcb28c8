"""Files that are written."""

from __future__ import annotations

from pathlib import Path

from elbowroom.errors import FileError

__all__ = ["written"]


def written(path: Path, text: str) -> Path:
    """Write a text file, and return its path."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error) from error
    return path


def unwritable(path: Path, error: OSError) -> FileError:
    """Return the error of a file that cannot be written."""
    hint = "a file in a folder that exists and can be written to"
    return FileError(f"{path}: cannot be written: {error}\n  write: {hint}", str(path), None, str(error), hint)
