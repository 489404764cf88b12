"""Checks audits with Manifold, if installed: volumes of clashes, and that no other pair overlaps.

- Parts that touch may overlap within the tolerance of their pair: by at most a layer as thick as
  the tolerance on the surface of the smaller part.
- Manifold counts a place with winding number 2 twice, so the pieces of a part are united first.
- Manifold loses facets of some parts in which four facets meet at an edge. Then the volume of the
  part differs, and its pairs are judged by rays alone: random vertical lines, on each of which the
  crossings of both surfaces give the exact winding numbers.
"""

import json
import subprocess
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Floats
from test_plans_judges import COLLECTION, ROUNDING, blocks, write

from colltrans import Assembly

GEARBOX = ROOT / "data" / "gearbox_small"
#: Assemblies outside this repository are checked if present, those in STEP if OCP is installed.
NAMES = ["burr_p3_19", "dovetail", "flange8", "key", "lid", "rail", "snap_hook", "valve_oring"]
NAMES += ["../gearbox", "../machines/vise.step", "../machines/enclosure2.step"]
NAMES += ["../step/as1-oc-214.stp"]
#: Assemblies with parts of several pieces that overlap, such as modelled threads.
THREADS = ["square_table/assembly.toml", "../machines/valveblock.step"]
#: The rays of a pair are one in each cell of a grid of this size.
CELLS = 300
#: The largest error of the rays' mean, in standard deviations.
DEVIATIONS = 3.0

Mesh = tuple[Floats, Any]


def signed_volume(mesh: Mesh) -> float:
    a, b, c = np.moveaxis((mesh[0] - mesh[0].mean(axis=0))[mesh[1]], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def body_of(manifold3d: Any, mesh: Mesh) -> Any:
    """Returns the union of the pieces of a part; ``None`` if Manifold has another body, or none."""
    body = manifold3d.Manifold(manifold3d.Mesh64(mesh[0], mesh[1].astype(np.uint64)))
    volume = signed_volume(mesh)
    is_whole = abs(body.volume() - volume) <= ROUNDING * abs(volume)
    if body.status() != manifold3d.Error.NoError or not is_whole:
        return None
    pieces = body.decompose()
    if len(pieces) > 1 and all(piece.volume() > 0 for piece in pieces):
        return manifold3d.Manifold.batch_boolean(pieces, manifold3d.OpType.Add)
    return body


def crossings(mesh: Mesh, low: Floats, side: Floats, places: Floats) -> Floats:
    """Returns where vertical lines cross a surface: rows of the line, the height, and 1 downwards.

    One line is in each cell of a grid, with the corner `low` and cells of the size `side`.
    """
    rows = [np.empty((0, 3))]
    facets = mesh[0][mesh[1]]
    first = np.floor((facets.min(axis=1)[:, :2] - low) / side).astype(int)
    last = np.floor((facets.max(axis=1)[:, :2] - low) / side).astype(int)
    seen = ((last >= 0) & (first < CELLS)).all(axis=1)
    facets, first = facets[seen], first[seen].clip(0)
    spans = last[seen].clip(max=CELLS - 1) - first + 1
    for span in np.unique(spans, axis=0):
        same = (spans == span).all(axis=1)
        i, j = first[same].T[:, :, None, None]
        line = (i + np.arange(span[0])[:, None]) * CELLS + j + np.arange(span[1])
        line = line.reshape(len(line), -1)
        # The sides opposite to the corners give their weights, as areas.
        x, y = np.moveaxis(facets[same][:, :, None, :2] - places[line][:, None], 3, 0)
        weights = np.roll(x, -1, 1) * np.roll(y, -2, 1) - np.roll(x, -2, 1) * np.roll(y, -1, 1)
        signs = np.sign(weights).sum(axis=1)
        inside = abs(signs) == 3
        heights = np.einsum("fck,fc->fk", weights, facets[same][:, :, 2])[inside]
        heights /= weights.sum(axis=1)[inside]
        rows.append(np.column_stack([line[inside], heights, -signs[inside] / 3]))
    return np.concatenate(rows)


def volume_by_rays(p: Mesh, q: Mesh, bounds: Floats) -> tuple[float, float]:
    """Returns the volume inside both of two parts within a box, and its standard deviation."""
    (low, high), random = bounds, np.random.default_rng(1)
    side = (high - low)[:2] / CELLS
    cells = np.stack(np.divmod(np.arange(CELLS * CELLS), CELLS), axis=1)
    places = low[:2] + (cells + random.random(cells.shape)) * side
    found = [crossings(mesh, low[:2], side, places) for mesh in (p, q)]
    steps = [np.pad(found[0], ((0, 0), (0, 1))), np.insert(found[1], 2, 0.0, axis=1)]
    rows = np.concatenate(steps)
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    line, winding = rows[:, 0].astype(int), rows[:, 2:].cumsum(axis=0)
    # The surfaces are closed, so that the sums are 0 at the end of each line.
    assert not winding[np.append(np.diff(line) != 0, True)].any()
    both = np.asarray((winding > 0).all(axis=1))[:-1]
    lengths = np.bincount(line[:-1][both], np.diff(rows[:, 1])[both], CELLS * CELLS)
    # The variance within cells is at most that between neighbours.
    table = lengths.reshape(CELLS, CELLS)
    variance = np.mean(np.diff(table, axis=1) ** 2) / 2 / CELLS**2
    area = side.prod() * CELLS**2
    return float(lengths.mean() * area), float(np.sqrt(variance) * area)


def judged(cli: Path, source: Path, *, by_rays: bool = False) -> dict[str, int]:
    """Compares an audit with Manifold, and returns the number of pairs of each finding.

    With `by_rays` the volumes are also compared with rays.
    """
    manifold3d = pytest.importorskip("manifold3d")
    command: list[str | Path] = [cli, "audit", source, "--json"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode in (0, 1), ran.stderr
    told = json.loads(ran.stdout)
    found = {tuple(sorted(pair["parts"])): pair for pair in told["pairs"]}
    counts = dict.fromkeys(["interfering", "contained", "touching", "apart"], 0)
    meshes = Assembly.read(source).meshes()
    bodies = {name: body_of(manifold3d, mesh) for name, mesh in meshes.items()}
    for a, b in combinations(sorted(bodies), 2):
        pair = found.get((a, b), {"finding": "apart", "tolerance": 0.0})
        p, q = bodies[a], bodies[b]
        if by_rays and "volume" in pair:
            volume, deviation = volume_by_rays(meshes[a], meshes[b], np.array(pair["box"]))
            lower, upper = pair["volume"]
            error = DEVIATIONS * deviation
            assert error <= 0.04 * upper, (pair, volume, deviation)
            assert lower - error <= volume <= upper + error, (pair, volume, deviation)
        if p is None or q is None:
            continue
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


@pytest.mark.parametrize("name", THREADS)
def test_parts_of_pieces_that_overlap(cli: Path, name: str) -> None:
    source = COLLECTION / name
    if not source.exists():
        pytest.skip("it is not there")
    if source.suffix == ".step":
        pytest.importorskip("OCP")
    assert judged(cli, source, by_rays=True)["interfering"] >= 2
