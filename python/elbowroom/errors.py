"""The exceptions of elbowroom: one hierarchy, each with what is wrong and what to write instead."""

from __future__ import annotations

__all__ = ["ArgumentError", "ArrayError", "Error", "FileError"]


class Error(Exception):
    """The base of all exceptions of this package."""


class FileError(Error):
    """A file was refused, or a question about the cell that it describes.

    Attributes
    ----------
    file
        Path of the file.
    line
        Line in the file, counted from 1; `None` for files without lines.
    message
        What is wrong.
    hint
        What to write instead; `None` if that is not known.
    """

    def __init__(
        self, text: str, file: str = "", line: int | None = None, message: str = "", hint: str | None = None
    ) -> None:
        super().__init__(text, file, line, message, hint)
        self.file = file
        self.line = line
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])


class ArgumentError(Error, ValueError):
    """An argument has a value that is not possible."""


class ArrayError(ArgumentError):
    """An array has a wrong shape, type or value."""
