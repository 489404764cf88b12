"""Tests free directions: closed forms, casts, proofs and the bits of the command line."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from colltrans import ConvexPolyhedron, Solid, SolidCast, SolidFree, free_directions
from colltrans.errors import QueryError
from colltrans.removal import FreeDirections

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
BOLT, PLATE = ROOT / "data" / "bolt.stl", ROOT / "data" / "plate.off"


def lid() -> FreeDirections:
    return free_directions(CUBE, CUBE, moving_pose=[0, 0, 1])


def test_a_lid_is_free_along_half_of_all_directions() -> None:
    found = lid()
    low, high = found.free_share
    assert low <= 0.5 <= high and high - low < 1e-12
    assert (found.outcome, found.undecided_share, found.tolerance) == ("free", 0.0, 0.0)
    (region,) = found.regions
    assert region["corners"] == [] and np.allclose(region["center"], [0, 0, 1])
    assert found.says(np.array([[0, 1, 0], [0, 1, -1e-50], [3, 4, 5]])) == [
        "free",
        "blocked",
        "free",
    ]
    found.verify()
    assert repr(found).startswith("FreeDirections(")


def test_casts_agree_with_free_directions() -> None:
    bolt, plate = Solid.read(BOLT), Solid.read(PLATE)
    found = free_directions(bolt, plate, tolerance=0.1)
    rng = np.random.default_rng(29)
    near = np.array([0, 0, 1]) + rng.uniform(-0.05, 0.05, (100, 3))
    for d, word in zip(near, found.says(near), strict=True):
        answer = SolidCast(bolt, plate, d, tolerance=0.1).clearance()
        assert isinstance(answer, SolidFree) == (word == "free")


def test_the_command_line_has_the_same_bits(cli: Path, tmp_path: Path) -> None:
    found = free_directions(Solid.read(BOLT), Solid.read(PLATE))
    told = subprocess.run(
        [cli, "directions", BOLT, PLATE, "--json"], capture_output=True, text=True
    )
    assert json.loads(told.stdout) == found.to_dict()
    proof = tmp_path / "proof.json"
    found.save_proof(proof)
    assert subprocess.run([cli, "verify", proof], capture_output=True).returncode == 0


def test_bodies_that_overlap_are_refused() -> None:
    with pytest.raises(QueryError, match="overlap at the start"):
        free_directions(CUBE, CUBE, moving_pose=[0.5, 0, 0])
    through = free_directions(CUBE, CUBE, moving_pose=[0.5, 0, 0], ignore_start_overlaps=True)
    assert through.outcome in {"free", "blocked"}
    little = free_directions(CUBE, CUBE, moving_pose=[0, 0, 1], looks=0)
    assert little.undecided_share > 0.99 and little.says([[0, 0, 1]]) == ["undecided"]


def test_arcs_and_points_are_exact() -> None:
    cuboid = ConvexPolyhedron.cuboid
    lower, upper = cuboid([-5, -5, -1], [5, 5, 0]), cuboid([-5, -5, 1], [5, 5, 2])
    side = cuboid([-2, -5, 0], [0, 5, 1])
    circle = free_directions(CUBE, Solid.from_pieces([lower, upper]))
    (arc,) = circle.arcs
    assert "ends" not in arc and arc["along"][0] == arc["along"][-1] and circle.points == []
    assert circle.is_on(0, np.array([[3, 7, 0], [3, 7, 1e-50]])) == [True, False]
    (arc,) = free_directions(CUBE, Solid.from_pieces([lower, upper, side])).arcs
    assert len(arc["ends"]) == 2
    for end in arc["ends"]:
        normals = [plane["normal"] for plane in end["planes"]]
        assert np.allclose(np.cross(*normals), end["direction"])
        assert all(len(plane["of"]["vertices"]) == 3 for plane in end["planes"])
    walls = [cuboid([-5, 1, 0], [5, 2, 1]), cuboid([-5, -1, 0], [5, 0, 1])]
    bar = free_directions(CUBE, Solid.from_pieces([lower, upper, *walls]))
    assert sorted(point["direction"] for point in bar.points) == [[-1, 0, 0], [1, 0, 0]]
    assert sum(bar.is_at(k, [[2, 0, 0]])[0] for k in range(2)) == 1
    assert bar.is_at(0, [[1, 1e-50, 0]]) == [False]
    with pytest.raises(IndexError, match="no point 2"):
        bar.is_at(2, [[1, 0, 0]])
