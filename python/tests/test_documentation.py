"""The documentation site."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import elbowroom as er
from conftest import ROOT

DOCS = ROOT / "python/docs"


def test_every_name_has_a_page() -> None:
    listed = re.findall(r"^   elbowroom\.(\w+)$", (DOCS / "index.rst").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(listed) == sorted({*er.__all__, "sweep"} - {"__version__"})


def test_the_site_is_built_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("sphinx")
    # Its pages are generated beside its sources.
    shutil.copytree(DOCS, tmp_path / "docs")
    build = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", str(tmp_path / "docs"), str(tmp_path / "site")]
    done = subprocess.run(build, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "site/classes/elbowroom.Checker.html").read_text(encoding="utf-8")
    # Its parameters, and a method with those of its own.
    assert "conservative" in page and "tolerance_m" in page
    assert not re.findall(r"(?:src|href)=\"https?://(?!\S*(?:sphinx-doc|alabaster|github\.com/sphinx))", page)
