"""The documentation is whole, and builds without a warning and without a network."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import colltrans

DOCS = ROOT / "python" / "docs"


def test_every_public_name_is_in_the_reference() -> None:
    told = re.findall(r":: colltrans\.(\w+)\n", (DOCS / "api.md").read_text())
    assert sorted(told) == sorted(colltrans.__all__)


def test_every_page_is_in_the_table_of_contents() -> None:
    index = (DOCS / "index.md").read_text()
    pages = {f"pages/{page.stem}" for page in (ROOT / "docs").glob("*.md")}
    pages |= {f"tutorials/{page.stem}" for page in (DOCS / "tutorials").glob("*.md")}
    assert all(f"\n{page}\n" in index for page in pages), pages


def test_it_builds_without_a_warning(tmp_path: Path) -> None:
    for package in ("sphinx", "numpydoc", "myst_parser"):
        pytest.importorskip(package)
    words = ["-q", "-W", "--keep-going", "-E", "-b", "html", "-d", str(tmp_path / "doctrees")]
    command = [sys.executable, "-m", "sphinx", *words, str(DOCS), str(tmp_path / "html")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "html" / "api.html").read_text()
    assert 'id="colltrans.Contact.pose_before"' in page
    assert (tmp_path / "html" / "pages" / "solids.html").exists()
