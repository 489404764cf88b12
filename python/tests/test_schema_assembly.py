"""Tests that ``assembly --json`` matches ``docs/answers.schema.json``."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from test_schema import DATA, ask, conform

TRAY = """OFF
8 4 0
-2 -2 0
2 -2 0
2 2 0
-2 2 0
-2 -2 1
2 -2 1
2 2 1
-2 2 1
4 0 3 2 1
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
"""


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["--keep-apart", "0.01"],
        ["--map", "cover", "--direction", "z"],
        ["--tolerance", "0", "--direction", "x"],
    ],
)
def test_assemblies(cli: Path, words: Sequence[str]) -> None:
    found = ask(cli, ["assembly", str(DATA / "gearbox_small"), *words])
    assert found["parts"] and found["rooms"]
    conform("assembly", found)


def test_surfaces_and_overlaps(cli: Path, tmp_path: Path) -> None:
    (tmp_path / "tray.off").write_text(TRAY)
    (tmp_path / "bolt.stl").write_bytes((DATA / "bolt.stl").read_bytes())
    found = ask(cli, ["assembly", str(tmp_path)])
    tray = found["parts"][1]
    assert "shells" in tray and tray["volume"] is None and tray["volume_bounds"] is None
    conform("assembly", found)


@pytest.mark.parametrize(
    "words", [[], ["--within", "0.5"], ["--within", "bolt*,bearing*=30", "--allow-contact"]]
)
def test_audits(cli: Path, tmp_path: Path, words: Sequence[str]) -> None:
    code = 1 if words else 0
    found = ask(cli, ["audit", str(DATA / "gearbox_small"), *words], code)
    assert found["parts"] and found["counts"]["examined"] > 0
    conform("audit", found)
    (tmp_path / "tray.off").write_text(TRAY)
    (tmp_path / "bolt.stl").write_bytes((DATA / "bolt.stl").read_bytes())
    (tmp_path / "again.stl").write_bytes((DATA / "bolt.stl").read_bytes())
    found = ask(cli, ["audit", str(tmp_path)], 1)
    assert found["pairs"][0]["finding"] == "interfering"
    conform("audit", found)
