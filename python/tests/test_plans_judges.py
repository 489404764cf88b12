"""Checks every move of every plan with Manifold, if installed: no two parts overlap.

Plans use parts that are shrunk by half the tolerance; the check moves the original parts. So the
overlap of two parts is at most a layer as thick as the tolerance on the surface of the smaller.
"""

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

from colltrans import Solid

#: The number of checked times of each move, and Manifold's relative rounding of volumes.
PLACES = 40
ROUNDING = 1e-9
#: The relative distance of a second check, because Manifold can be wrong for coplanar facets.
NUDGE = 1e-9
#: Assemblies outside this repository are checked if present.
COLLECTION = ROOT.parent / "shared" / "data" / "assemblies"
NAMES = ["burr_p3_19", "key", "key_tight_turned", "keyhole_L", "maze_2", "maze_8"]
NAMES += ["two_step_pocket", "dovetail", "flange8", "pillow_block"]
#: More folders of parts, as `plans --parts` of the benchmarks writes them.
MACHINES = os.environ.get("COLLTRANS_MACHINES")


def write(path: Path, body: Any) -> None:
    mesh = body.to_mesh64()
    vertices, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)
    lines = ["OFF", f"{len(vertices)} {len(triangles)} 0"]
    lines += [" ".join(repr(float(x)) for x in v) for v in vertices]
    lines += ["3 " + " ".join(str(int(k)) for k in t) for t in triangles]
    path.write_text("\n".join(lines) + "\n")


def moves(step: dict[str, Any]) -> Iterator[tuple[dict[str, Any], bool]]:
    """Returns the moves of a step, each with whether the part has left."""
    yield from ((leg, False) for leg in step["path"])
    yield from ((leg, True) for leg in step.get("back", []))


class Judge:
    """The parts of an assembly at their poses."""

    def __init__(self, manifold3d: Any, told: dict[str, Any], parts: dict[str, list[Path]]) -> None:
        def body(file: Path) -> Any:
            part = Solid.read(file)
            # Copies, because Manifold needs writable arrays.
            vertices, triangles = np.array(part.vertices), np.array(part.triangles, np.uint64)
            made = manifold3d.Manifold(manifold3d.Mesh64(vertices, triangles))
            assert made.status() == manifold3d.Error.NoError
            return made

        def union(files: list[Path]) -> Any:
            bodies = [body(file) for file in files]
            return manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add)

        self.tolerance = told["tolerance"]
        self.bodies = {name: union(files) for name, files in parts.items()}
        self.at = {name: np.zeros(3) for name in parts}
        self.looks = 0

    def layer(self, a: str, b: str) -> float:
        area = min(self.bodies[name].surface_area() for name in (a, b))
        volume = min(self.bodies[name].volume() for name in (a, b))
        return float(self.tolerance * area + ROUNDING * volume)

    def common(self, a: str, b: str, by: Any) -> float:
        """Returns the volume of the overlap of two parts, the first displaced."""
        p, q = self.bodies[a], self.bodies[b]
        low, high = np.array(p.bounding_box()).reshape(2, 3) + by
        least, most = np.array(q.bounding_box()).reshape(2, 3)
        if (high <= least).any() or (most <= low).any():
            return 0.0
        self.looks += 1
        return float((p.translate(tuple(by)) ^ q).volume())

    def turn(self, leg: dict[str, Any], others: list[str]) -> None:
        """Checks a screw with the parts at their poses; after it they count as straight."""
        turn = leg["turn"]
        axis, pivot = np.array(turn["axis"]), np.array(turn["point"])
        for part in leg["parts"]:
            own = pivot - turn["aside"]
            for share in np.linspace(0, 1, PLACES + 1):
                angle = 2 * np.pi * (turn["phase"] + turn["turns"] * share)
                k = np.cross(axis, np.eye(3)).T
                rotation = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
                by = pivot - rotation @ own + axis * leg["travel"] * share
                body = self.bodies[part].transform(np.column_stack([rotation, by]))
                for other in others:
                    self.looks += 1
                    common = float((body ^ self.bodies[other]).volume())
                    layer = self.layer(part, other)
                    layer += turn["proof"]["tolerance"] * body.surface_area()
                    assert common <= layer, (part, other, share, leg)
            self.bodies[part] = body.translate(tuple(-axis * leg["travel"]))
            self.at[part] = axis * leg["travel"]

    def move(self, leg: dict[str, Any], others: list[str]) -> None:
        if "turn" in leg:
            self.turn(leg, others)
            return
        motion = np.array(leg["direction"]) * leg["travel"]
        for a in leg["parts"]:
            for b in others:
                for share in np.linspace(0, 1, PLACES + 1):
                    by = self.at[a] - self.at[b] + motion * share
                    common = self.common(a, b, by)
                    if common > self.layer(a, b):
                        # The second check decides: over so short a way the overlap changes by at
                        # most the surface times the way.
                        change = NUDGE * leg["travel"] * self.bodies[a].surface_area()
                        common = self.common(a, b, by + NUDGE * motion) + float(change)
                    assert common <= self.layer(a, b), (a, b, share, leg)
        for part in leg["parts"]:
            self.at[part] = self.at[part] + motion

    def plan(self, told: dict[str, Any]) -> None:
        there, inside = set(self.at), dict[int, set[str]]()
        for number, step in enumerate(told["plan"]):
            gone = set(step["parts"])
            within = step.get("within")
            around = there if within is None else inside[within]
            for part in around:
                self.at[part] = np.zeros(3)
            for leg, has_left in moves(step):
                # Parts that have left are far away and move on alone.
                sides = [around - gone, gone] if has_left else [around]
                for side in sides:
                    own = [part for part in leg["parts"] if part in side]
                    self.move({**leg, "parts": own}, sorted(side - set(own)))
            inside[number] = set(gone)
            around -= gone
        assert there == {*told["left"], *told["last"]}


def judge_of(told: dict[str, Any], folder: Path) -> Judge:
    manifold3d = pytest.importorskip("manifold3d")
    manifest = folder / "assembly.json"
    if manifest.exists():
        listed = json.loads(manifest.read_text())["parts"]
        parts = {part["name"]: [folder / file for file in part["file"]] for part in listed}
    else:
        files = [file for kind in ("off", "stl") for file in folder.glob(f"*.{kind}")]
        parts = {file.stem: [file] for file in files}
    return Judge(manifold3d, told, parts)


def judged(cli: Path, folder: Path, *words: str) -> tuple[dict[str, Any], Judge]:
    pytest.importorskip("manifold3d")
    manifest = folder / "assembly.json"
    source = manifest if manifest.exists() else folder
    command: list[str | Path] = [cli, "assembly", source, "--json", *words]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    told = json.loads(ran.stdout)
    judge = judge_of(told, folder)
    judge.plan(told)
    return told, judge


def blocks(manifold3d: Any, *all_of: tuple[list[float], list[float]]) -> Any:
    def block(low: list[float], high: list[float]) -> Any:
        size = [float(b - a) for a, b in zip(low, high, strict=True)]
        return manifold3d.Manifold.cube(size).translate([float(x) for x in low])

    made = block(*all_of[0])
    for one in all_of[1:]:
        made += block(*one)
    return made


def test_a_gearbox(cli: Path) -> None:
    told, judge = judged(cli, ROOT / "data" / "gearbox_small")
    assert len(told["plan"]) == 10 and judge.looks > 500


def test_a_key_in_a_slot(cli: Path, tmp_path: Path) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    slot = blocks(manifold3d, ([-1, -3, -1], [21, 3, 2]))
    slot -= blocks(manifold3d, ([0, -2, 0], [20, 2, 1]), ([0, -1, 0.5], [20, 1, 3]))
    slot -= blocks(manifold3d, ([14, -2, 0.5], [17, 2, 3]))
    key = ([0.5, -1.5, 0.2], [2.5, 1.5, 0.8]), ([0.5, -0.5, 0.5], [2.5, 0.5, 3])
    write(tmp_path / "slot.off", slot)
    write(tmp_path / "key.off", blocks(manifold3d, *key))
    told, judge = judged(cli, tmp_path)
    assert len(told["plan"][0]["path"]) == 2 and judge.looks > 20
    # Manifold finds a move that goes too far.
    told["plan"][0]["path"][0]["travel"] += 4
    judge.at = dict.fromkeys(judge.at, np.zeros(3))
    with pytest.raises(AssertionError):
        judge.plan(told)


def test_a_lid_that_makes_room_and_goes_back(cli: Path, tmp_path: Path) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    tray = blocks(manifold3d, ([-1, -1, -1], [9, 4, 4]))
    tray -= blocks(manifold3d, ([0, 0, 0], [4, 3, 5]), ([0, -0.5, 2], [8.5, 3.5, 3]))
    tray -= blocks(manifold3d, ([0, 0, 2], [8.5, 3, 5]))
    write(tmp_path / "tray.off", tray)
    write(tmp_path / "cube.off", blocks(manifold3d, ([1, 1, 0.5], [2, 2, 1.5])))
    write(tmp_path / "lid.off", blocks(manifold3d, ([0.1, -0.4, 2.2], [3.9, 3.4, 2.8])))
    told, judge = judged(cli, tmp_path)
    assert told["plan"][0]["parts"] == ["cube"] and told["plan"][0]["back"][0]["parts"] == ["lid"]
    assert judge.looks > 20


@pytest.mark.parametrize("name", NAMES)
def test_the_collection(cli: Path, name: str) -> None:
    folder = COLLECTION / name
    if not folder.is_dir():
        pytest.skip("it is not there")
    told, judge = judged(cli, folder)
    assert told["plan"] and judge.looks > 0


@pytest.mark.skipif(MACHINES is None, reason="COLLTRANS_MACHINES names no folder")
def test_machines(cli: Path) -> None:
    for folder in sorted(Path(MACHINES or ".").iterdir()):
        told, judge = judged(cli, folder, "--auto")
        assert told["plan"] and not told["stuck"] and judge.looks > 0, folder
        turns = [leg["turn"] for step in told["plan"] for leg in step["path"] if "turn" in leg]
        if turns:
            # Manifold finds a turn in the wrong direction.
            turns[0]["turns"] *= -1
            with pytest.raises(AssertionError):
                judge_of(told, folder).plan(told)
