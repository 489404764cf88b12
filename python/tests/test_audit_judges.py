"""Checks audits with Manifold, if installed: volumes of clashes, and that no other pair overlaps.

Parts that touch may overlap within the tolerance of their pair: by at most a layer as thick as the
tolerance on the surface of the smaller part.
"""

import json
import subprocess
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from test_plans_judges import COLLECTION, ROUNDING, blocks, write

from colltrans import Assembly

GEARBOX = ROOT / "data" / "gearbox_small"
#: Assemblies outside this repository are checked if present, those in STEP if OCP is installed.
NAMES = ["burr_p3_19", "dovetail", "flange8", "key", "lid", "rail", "snap_hook", "valve_oring"]
NAMES += ["../gearbox", "../machines/vise.step", "../machines/enclosure2.step"]
NAMES += ["../step/as1-oc-214.stp"]


def bodies_of(manifold3d: Any, source: Path) -> dict[str, Any]:
    """Returns all parts in world coordinates, except those that are not closed manifolds."""

    def body(vertices: Any, triangles: Any) -> Any:
        return manifold3d.Manifold(manifold3d.Mesh64(vertices, triangles.astype(np.uint64)))

    made = {name: body(*mesh) for name, mesh in Assembly.read(source).meshes().items()}
    return {k: v for k, v in made.items() if v.status() == manifold3d.Error.NoError}


def judged(cli: Path, source: Path) -> dict[str, int]:
    """Compares an audit with Manifold, and returns the number of pairs of each finding."""
    manifold3d = pytest.importorskip("manifold3d")
    command: list[str | Path] = [cli, "audit", source, "--json"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode in (0, 1), ran.stderr
    told = json.loads(ran.stdout)
    found = {tuple(sorted(pair["parts"])): pair for pair in told["pairs"]}
    counts = dict.fromkeys(["interfering", "contained", "touching", "apart"], 0)
    bodies = bodies_of(manifold3d, source)
    for a, b in combinations(sorted(bodies), 2):
        pair = found.get((a, b), {"finding": "apart", "tolerance": 0.0})
        p, q = bodies[a], bodies[b]
        least = min(p.volume(), q.volume())
        volume = (p ^ q).volume()
        if "volume" in pair:
            lower, upper = pair["volume"]
            assert lower - ROUNDING * least <= volume <= upper + ROUNDING * least, (pair, volume)
        else:
            layer = pair["tolerance"] * min(p.surface_area(), q.surface_area())
            assert volume <= layer + ROUNDING * least, (a, b, pair, volume)
        counts[pair["finding"]] += 1
    return counts


def test_a_gearbox(cli: Path) -> None:
    counts = judged(cli, GEARBOX)
    assert counts["touching"] == 21 and counts["interfering"] == 0


def test_bodies_that_overlap_by_known_volumes(cli: Path, tmp_path: Path) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    frame = blocks(manifold3d, ([0, 0, 0], [10, 10, 4])) - blocks(
        manifold3d, ([3, 3, -1], [7, 7, 5])
    )
    write(tmp_path / "frame.off", frame)
    write(
        tmp_path / "bar.off",
        manifold3d.Manifold.cylinder(14, 1, circular_segments=48)
        .rotate((0, 80, 10))
        .translate((-2, 4, 1)),
    )
    write(tmp_path / "ball.off", manifold3d.Manifold.sphere(1, 40).translate((1.5, 8, 2)))
    write(
        tmp_path / "plug.off",
        manifold3d.Manifold.cylinder(9, 2, circular_segments=64).translate((5, 5, -2)),
    )
    assert judged(cli, tmp_path) == {"interfering": 2, "contained": 1, "touching": 1, "apart": 2}


@pytest.mark.parametrize("name", NAMES)
def test_the_collection(cli: Path, name: str) -> None:
    source = COLLECTION / name
    if not source.exists():
        pytest.skip("it is not there")
    if source.suffix in (".step", ".stp"):
        pytest.importorskip("OCP")
    counts = judged(cli, source)
    assert sum(counts.values()) > 0
