"""Types by pyright: of the package, and of the notebooks that use it. mypy is run by the tests of the crate."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

import elbowroom
from conftest import ROOT
from test_notebooks import NOTEBOOKS, cells


def test_pyright_finds_no_error_in_the_package_and_the_notebooks(tmp_path: Path) -> None:
    if find_spec("basedpyright") is None:
        pytest.skip("skipped: no basedpyright")
    shutil.copytree(Path(elbowroom.__file__).parent, tmp_path / "elbowroom", ignore=shutil.ignore_patterns("*.so"))
    for notebook in NOTEBOOKS:
        code = "\n".join("".join(cell["source"]) for cell in cells(notebook))
        (tmp_path / f"notebook_{notebook.stem}.py").write_text(code, encoding="utf-8")
    settings = tomllib.loads((ROOT / "python/pyproject.toml").read_text(encoding="utf-8"))["tool"]["pyright"]
    # The notebook beside Coal runs with and without it.
    settings |= {"include": ["."], "reportMissingImports": False}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    words = [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable]
    found = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert found.returncode == 0 and "0 errors" in found.stdout, found.stdout[-3000:]
