"""Tests that the same files give the same bodies and answers in Python, command line and page."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Batch

import colltrans
from colltrans import Contact, ContactRange, Solid, SolidBlocked, SolidCast

HOME = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
TILTED = [0.5, 0.25, 7.0, 0.2, 0.3, 0.1, 0.9273618495495704]
DIRECTION = [0.0, 0.0, -1.0]
CORNERS = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"]
SIDES = ["4 0 3 2 1", "4 4 5 6 7", "4 0 1 5 4", "4 1 2 6 5", "4 2 3 7 6", "4 3 0 4 7"]


def off(corners: list[str], sides: list[str]) -> str:
    return "\n".join([f"OFF\n{len(corners)} {len(sides)} 0", *corners, *sides]) + "\n"


def float_ply() -> str:
    head = "ply\nformat ascii 1.0\nelement vertex 8\n"
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    faces = "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    return head + axes + faces + "\n".join([*CORNERS, *SIDES]) + "\n"


FILES = {
    "single.ply": float_ply(),
    # A corner that was computed twice.
    "twins.off": off([*CORNERS, "0 0 5e-17"], [*SIDES[:5], "4 3 8 4 7"]),
    # A face with the opposite orientation.
    "turned.off": off(CORNERS, [*SIDES[:5], "4 7 4 0 3"]),
    "inside_out.off": off(
        CORNERS, [" ".join(["4", *reversed(side.split()[1:])]) for side in SIDES]
    ),
    "open.off": off(CORNERS, SIDES[1:]),
}


def page(lines: list[str]) -> list[dict[str, Any]]:
    """Returns the answers of the page's module, built natively."""
    crate = ROOT / "crates/colltrans-wasm/Cargo.toml"
    command: list[str | Path] = [
        "cargo",
        "run",
        "--quiet",
        "--release",
        "--example",
        "native",
        # As `.ci/run tests` compiles it.
        "--features",
        "assembly,min-gap",
        "--config",
        ROOT / ".ci/quick.toml",
        "--manifest-path",
        crate,
    ]
    told = subprocess.run(
        command, input="\n".join(lines), capture_output=True, text=True, check=True
    )
    return [json.loads(line) for line in told.stdout.splitlines()]


def of_page(moving: Path, fixed: Path, pose: list[float], how: str) -> list[dict[str, Any]]:
    load = [
        f"{path}\t{json.dumps({'do': 'load', 'slot': slot, 'name': path.name, 'take': how})}"
        for slot, path in (("moving", moving), ("fixed", fixed))
    ]
    asked = {"do": "cast", "moving_pose": pose, "fixed_pose": HOME, "direction": DIRECTION}
    return page([*load, json.dumps(asked)])


@pytest.mark.parametrize(
    "pose", [[4.0, 0.0, 7.0, 0.0, 0.0, 0.0, 1.0], TILTED], ids=["home", "tilted"]
)
@pytest.mark.parametrize("name", ["bolt.stl", *FILES])
def test_the_same_file_gives_the_same_body(
    batch: Batch, tmp_path: Path, name: str, pose: list[float]
) -> None:
    path, plate = ROOT / "data" / name, ROOT / "data/plate.off"
    if name in FILES:
        path = tmp_path / name
        path.write_text(FILES[name])
    is_open = name.startswith("open")
    moving, fixed = Solid.read(path, open=is_open), Solid.read(plate)
    query = SolidCast(moving, fixed, DIRECTION, moving_pose=pose)
    here = query.clearance()
    assert isinstance(here, SolidBlocked)
    body = {"solid": str(path), **({"open": True} if is_open else {})}
    place = {"translation": pose[:3], "rotation": pose[3:]}
    asked = {"moving": body, "fixed": {"solid": str(plate)}, "direction": DIRECTION}
    (there,) = batch([{**asked, "moving_pose": place, "query": "clearance"}])
    *loaded, told = of_page(path, plate, pose, "open" if is_open else "solid")
    seen = told["record"]
    found = here.contact
    assert query.tolerance == there["tolerance"] == seen["tolerance"]
    assert here.distance == there["distance"] == seen["distance"]
    assert found.translation == there["translation"] == seen["translation"]
    assert found.offset_distance == there["offset_distance"] == seen["offset_distance"]
    assert query.exit() == there["exit"] == seen["exit"]
    assert np.array_equal(found.normal, there["normal"])
    assert found.normal.tolist() == seen["normal"]
    assert loaded[0]["body"]["notes"] == moving.notes
    assert there.get("notes", []) == [f"{path}: {note}" for note in moving.notes]
    if name.endswith((".ply", ".stl")):
        assert query.tolerance >= 2 * moving.precision > 1e-7
    else:
        assert moving.notes


def test_the_same_file_gives_the_same_hull(batch: Batch) -> None:
    bolt, bracket = ROOT / "data/bolt.stl", ROOT / "data/bracket.obj"
    hull = colltrans.read(bolt, hull=True)
    here = colltrans.contact_range(
        hull, colltrans.read(bracket, hull=True), DIRECTION, moving_pose=TILTED
    )
    assert isinstance(here, ContactRange) and isinstance(here.first, Contact)
    place = {"translation": TILTED[:3], "rotation": TILTED[3:]}
    asked = {
        "moving": {"mesh": str(bolt), "hull": True},
        "fixed": {"mesh": str(bracket), "hull": True},
    }
    (there,) = batch([{**asked, "direction": DIRECTION, "moving_pose": place}])
    *loaded, seen = of_page(bolt, bracket, TILTED, "hull")
    assert here.first.translation == there["translation"] == seen["record"]["translation"]
    # The page does not compute dents, so that it opens at once.
    (note,) = hull.notes
    assert note.startswith(loaded[0]["body"]["notes"][0])
    assert loaded[1]["body"]["notes"] == []
