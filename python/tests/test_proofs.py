"""Tests that saved proofs equal those of the command line and that both checkers accept them."""

import pickle
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import (
    Cast,
    ConvexPolyhedron,
    Grazing,
    InputError,
    Pair,
    Slides,
    Solid,
    SolidCast,
    check,
)

DATA = ROOT / "data"
Verify: TypeAlias = Callable[[Path], str]


@pytest.fixture
def verify(cli: Path) -> Verify:
    """Returns the output of ``colltrans verify`` for a file."""

    def ask(path: Path) -> str:
        told = subprocess.run([cli, "verify", path], capture_output=True, text=True)
        assert told.returncode == 0, told.stderr
        return told.stdout

    return ask


def of_command_line(cli: Path, path: Path, words: list[str]) -> bytes:
    command: list[str | Path] = [cli, *words, "--json", "--save-proof", path]
    subprocess.run(command, check=True, cwd=DATA, capture_output=True)
    return path.read_bytes()


@pytest.mark.parametrize("start", [[-5, 0.2, 0.3], [-5, 9, 0.3], [5, 0.2, 0.3], [0, 0.2, 0.3]])
def test_proofs_of_convex_bodies_hold(cli: Path, tmp_path: Path, start: list[float]) -> None:
    here, there = tmp_path / "here.json", tmp_path / "there.json"
    names = ["ellipsoid_a.obj", "ellipsoid_b.off"]
    moving, fixed = (colltrans.read(DATA / name) for name in names)
    query = Cast(moving, fixed, [1, 0.1, 0.2], moving_pose=start)
    more = [*names, "--direction", "1,0.1,0.2", "--moving-pose", ",".join(map(str, start))]
    for answer, name in [(query.contact_range(), "cast"), (query.clearance(), "clearance")]:
        answer.save_proof(here)
        assert here.read_bytes() == of_command_line(cli, there, [name, *more])
        assert here.read_text() == answer.proof_json() + "\n"
        assert check.check(answer.proof_json()).holds


@pytest.mark.parametrize(
    ("start", "direction"),
    [
        ([0, 0, 9], [0, 0, -1]),
        ([0, 40, 9], [0, 0, 1]),
        ([0.5, 0, 0], [0, 0, -1]),
    ],
)
def test_proofs_of_solids_hold(
    cli: Path, tmp_path: Path, start: list[float], direction: list[float]
) -> None:
    here, there = tmp_path / "here.json", tmp_path / "there.json"
    bolt, plate = Solid.read(DATA / "bolt.stl"), Solid.read(DATA / "plate.off")
    answer = SolidCast(bolt, plate, direction, moving_pose=start).clearance()
    answer.save_proof(here)
    pose, way = (",".join(map(str, row)) for row in (start, direction))
    asked = [
        "clear",
        "bolt.stl",
        "--from",
        "plate.off",
        f"--direction={way}",
        "--moving-pose",
        pose,
    ]
    assert here.read_bytes() == of_command_line(cli, there, asked)


def test_proofs_of_answers_and_their_parts_hold(tmp_path: Path, verify: Verify) -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    cloud = ConvexPolyhedron(np.random.default_rng(5).normal(size=(30, 3)))
    found: list[Any] = []
    for body in (cube, cloud):
        for start in ([-3, 0.5, 0.25], [0.25, 0.5, 0.125], [3, 0.5, 0], [-3, 9, 0]):
            query = Cast(body, cube, [1, 0.125, 0], moving_pose=start)
            found += [query.cast(), query.contact_range(), query.clearance()]
            found += [query.directional_depth(), query.intersects()]
    found += [part.last.turned for part in found if isinstance(part, colltrans.ContactRange)]
    found += [part.contact for part in found if isinstance(part, colltrans.Behind)]
    for answer in found:
        answer.save_proof(tmp_path / "proof.json")
        assert verify(tmp_path / "proof.json").startswith("holds: ")
        assert check.check(answer.proof_json()).holds


def test_a_proof_of_a_slide_names_the_slide(tmp_path: Path, verify: Verify) -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    for start, tolerance in ([-3, 1, 0], 0.0), ([-3, 0.999, 0], 0.01):
        query = Cast(cube, cube, [1, 0, 0], moving_pose=start, graze_tolerance=tolerance)
        slides, grazing = query.clearance(), query.cast()
        assert isinstance(slides, Slides) and isinstance(grazing, Grazing)
        for answer in (slides, slides.grazing, grazing, query.contact_range()):
            answer.save_proof(tmp_path / "proof.json")
            told = verify(tmp_path / "proof.json")
            assert told.startswith("holds: the bodies slide along each other"), told
            assert "slide along each other" in check.check(answer.proof_json()).holds[0]


def test_unions_and_offset_bodies_have_proofs(tmp_path: Path, verify: Verify) -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    post = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])
    step = Solid.from_pieces([Solid.from_pieces([cube, post]), cube])
    plate, _ = Solid.read(DATA / "plate.off").shrunk(0.125)
    # Pieces that overlap have edges and facets in common.
    smaller, _ = step.shrunk(0.125)
    for body in (step, plate, smaller):
        blocked = SolidCast(cube, body, [0, 0, -1], moving_pose=[0.5, 0.5, 6]).clearance()
        assert isinstance(blocked, colltrans.SolidBlocked)
        assert blocked.contact.proof_json() == blocked.proof_json()
        blocked.save_proof(tmp_path / "proof.json")
        assert "stops the moving one before" in verify(tmp_path / "proof.json")
        assert check.check(blocked.proof_json()).holds


def test_an_unwritable_file_raises_an_error(tmp_path: Path) -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    with pytest.raises(OSError):
        colltrans.clearance(cube, cube, [1, 0, 0]).save_proof(tmp_path / "none" / "proof.json")


def test_common_parts_have_proofs(tmp_path: Path) -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    grain = ConvexPolyhedron.cuboid([0.25, 0.25, 0.25], [0.5, 0.5, 0.5])
    for moving, shift, volume, relation in [
        (cube, 0.75, 0.25, "crossing"),
        (grain, 0.0, 1 / 64, "moving_contained"),
        (cube, 2.0, 0.0, "disjoint"),
    ]:
        common = Pair(moving, cube, moving_pose=[shift, 0, 0]).common_part()
        lower, upper = common.volume
        assert lower <= volume <= upper <= volume + 1e-9
        assert (common.relation, common.point is None) == (relation, volume == 0)
        common.verify()
        common.save_proof(tmp_path / "proof.json")
        text = (tmp_path / "proof.json").read_text(encoding="utf-8")
        assert check.check(text).holds
        again = pickle.loads(pickle.dumps(common))
        assert again.volume == common.volume and again.proof_json() == common.proof_json()
    with pytest.raises(InputError, match="accuracy"):
        Pair(cube, cube).common_part(accuracy=-1)
