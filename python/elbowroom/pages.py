"""Pages: HTML that needs no network, in a notebook, a file or a browser."""

from __future__ import annotations

import html
import tempfile
import webbrowser
from pathlib import Path
from typing import Protocol

from elbowroom.errors import ArgumentError
from elbowroom.files import written

__all__ = ["Paged", "frame", "save", "show"]


class Paged(Protocol):
    """What has a page: a robot, a cell, a path, a run."""

    def page(self) -> str:
        """Return the page."""
        ...


def frame(page: str) -> str:
    """Return a page as a frame for a notebook."""
    return f'<iframe srcdoc="{html.escape(page, quote=True)}" style="width: 100%; height: 720px; border: 0"></iframe>'


def save(source: Paged, file: str | Path) -> Path:
    """Write the page of a robot, a cell, a path or a run to a file."""
    page = getattr(source, "page", None)
    if page is None:
        name = type(source).__name__
        raise ArgumentError(f"a {name} has no page\n  write: a Robot, a Cell, a Path or a Run")
    return written(Path(file), page())


def show(source: Paged) -> Path:
    """Open the page of a robot, a cell, a path or a run in the browser, and return its file in the folder of temporary files."""
    with tempfile.NamedTemporaryFile(prefix="elbowroom-", suffix=".html", delete=False) as file:
        pass
    path = save(source, file.name)
    webbrowser.open(path.as_uri())
    return path
