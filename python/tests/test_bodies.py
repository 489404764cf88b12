"""Tests bodies: construction, refusals, files, copies."""

import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, draw

import colltrans
from colltrans import (
    Cast,
    ConvexPolyhedron,
    InputError,
    Motion,
    MotionCast,
    Pose,
    SolidCast,
    cast_many,
)
from colltrans.answers import OffsetReport
from colltrans.errors import BuildError, CaseError, MeshError

CORNERS = np.vstack([np.zeros(3), np.eye(3)])
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def test_a_hull_drops_inner_points() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3)
    cube = ConvexPolyhedron(grid)
    assert (len(cube.vertices), len(cube.faces), cube.volume, cube.dimension) == (8, 6, 8.0, 3)
    assert np.array_equal(grid[cube.input_indices], cube.vertices)
    assert cube.vertices[cube.support([1, 1, 1])].tolist() == [2, 2, 2]
    normals = [cube.face_normal(face) for face in range(6)]
    for normal, face in zip(normals, cube.faces, strict=True):
        assert np.ptp(cube.vertices[face] @ normal) == 0
    with pytest.raises(IndexError):
        cube.face_normal(6)


@pytest.mark.parametrize("faces", [FACES, np.array(FACES), np.array(FACES, ">u2"), tuple(FACES)])
def test_faces_in_every_form_give_the_same_body(faces: object) -> None:
    assert ConvexPolyhedron.from_mesh(CORNERS, faces).volume == 1 / 6  # type: ignore[arg-type]


def test_polygons_of_different_lengths_are_accepted() -> None:
    pyramid = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]])
    faces = [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    assert len(ConvexPolyhedron.from_mesh(pyramid, faces).faces) == 5


@pytest.mark.parametrize(
    ("faces", "error", "match"),
    [
        (FACES[:3], BuildError, "the surface is open"),
        ([face[::-1] for face in FACES], BuildError, "oriented inwards"),
        ([[0, 1, 7]], BuildError, "face 0 names vertex 7"),
        ([[0, 1, -1]], InputError, "face 0: index -1"),
        (np.array([[0, 1, 1 << 40]]), InputError, "index 1099511627776"),
        ([[0, 1, 2.5]], InputError, "face 0: not an array of whole numbers"),
        ([], BuildError, "no faces"),
        (np.zeros((2, 2, 2), int), InputError, r"\(2, 2, 2\)"),
        (3, InputError, "not a list of faces"),
        ([[[0, 1, 2]]], InputError, "face 0"),
    ],
)
def test_invalid_faces_are_refused(faces: object, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        ConvexPolyhedron.from_mesh(CORNERS, faces)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("points", "error", "match"),
    [
        ([], BuildError, "no points"),
        ([[0, 0, np.nan]], BuildError, "point 0 is not finite"),
        ([[0, 0, 1e300]], BuildError, "exact range"),
        ([[0, 0]], InputError, r"\(1, 2\), not \(N, 3\)"),
        ([0, 0, 0], InputError, r"\(3,\), not \(N, 3\)"),
        ("points", InputError, "points: the text 'points' is not an array"),
    ],
)
def test_invalid_points_are_refused(points: object, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        ConvexPolyhedron(points)  # type: ignore[arg-type]


def test_bodies_pickle_and_copy_with_the_same_bits() -> None:
    settings = draw(seed=5, count=400)
    bodies = settings.bodies()
    again = pickle.loads(pickle.dumps(bodies))
    answers = [
        cast_many(
            those,
            those,
            settings.direction,
            moving_index=settings.moving,
            fixed_index=settings.fixed,
            moving_pose=settings.moving_pose,
        )
        for those in (bodies, again)
    ]
    assert answers[0].translation.tobytes() == answers[1].translation.tobytes()
    assert answers[0].normal.tobytes() == answers[1].normal.tobytes()
    assert copy.copy(bodies[0]) is bodies[0] and copy.deepcopy(bodies[0]) is bodies[0]
    with pytest.raises(CaseError, match="not a saved query"):
        ConvexPolyhedron.from_json("{")


def test_files_give_the_same_body_as_on_the_command_line(tmp_path: Path) -> None:
    parts = ROOT / "data"
    body = colltrans.read(parts / "dodecahedron.off")
    assert (len(body.vertices), len(body.faces)) == (20, 12)
    assert colltrans.read(str(parts / "dodecahedron.off"), scale=2).volume == 8 * body.volume
    with pytest.raises(BuildError, match=r"bolt\.stl: "):
        colltrans.read(parts / "bolt.stl")
    assert colltrans.read(parts / "bolt.stl", hull=True).dimension == 3
    with pytest.raises(MeshError, match="nothing.stl: cannot be read"):
        colltrans.read(tmp_path / "nothing.stl")
    (tmp_path / "part.step").write_text("ISO-10303-21;")
    with pytest.raises(MeshError, match="part.step"):
        colltrans.read(tmp_path / "part.step")
    with pytest.raises(InputError, match="scale"):
        colltrans.read(parts / "dodecahedron.off", scale=0)


def test_a_body_is_not_changed_by_its_arrays() -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    with pytest.raises(ValueError, match="read-only"):
        cube.vertices[:] = 7
    cube.faces[0][:] = 7
    assert cube.vertices.max() == 1 and cube.faces[0].max() < 8
    with pytest.raises(AttributeError):
        cube.volume = 3.0  # type: ignore[misc]


def test_a_cube_shrinks_and_grows() -> None:
    corners = [[x, y, z] for x in (0, 4) for y in (0, 4) for z in (0, 4)]
    points = np.array([[1, 1, 1], *corners])
    cube = ConvexPolyhedron(points)
    for (body, report), low, high in [(cube.shrunk(0.5), 0.5, 3.5), (cube.grown(1), -1, 5)]:
        assert (len(body.vertices), len(body.faces), body.dimension) == (8, 6, 3)
        assert body.volume == pytest.approx((high - low) ** 3, abs=1e-12)
        assert np.abs(body.vertices - np.where(body.vertices > 2, high, low)).max() < 1e-14
        assert np.array_equal(points[body.input_indices] > 2, body.vertices > 2)
        match report:
            case OffsetReport(farthest, vanished):
                assert farthest == pytest.approx(abs(low) * 3**0.5, abs=1e-12)
                assert vanished.dtype == np.uint32 and vanished.tolist() == []
            case other:
                raise AssertionError(other)
    assert (len(cube.vertices), cube.volume) == (8, 64)


def test_a_face_that_vanishes_in_shrinking_is_named() -> None:
    """A cube with a cut corner: the cut, x + y + z = 11.5, moves to 9.77, the corner to 9."""
    corners = np.array([[x, y, z] for x in (0, 4) for y in (0, 4) for z in (0, 4)][:-1])
    body = ConvexPolyhedron(np.vstack([corners, 4 - np.eye(3) / 2]))
    smaller, report = body.shrunk(1)
    assert smaller.volume == pytest.approx(8, abs=1e-12) and len(smaller.faces) == 6
    (cut,) = (f for f in range(7) if body.face_normal(f).min() > 0)
    assert report.vanished.tolist() == [cut]
    assert report.farthest == pytest.approx(3**0.5, abs=1e-12)
    again = pickle.loads(pickle.dumps(report))
    assert (
        repr(again)
        == repr(report)
        == f"OffsetReport(farthest={report.farthest!r}, vanished=[{cut}])"
    )
    back = pickle.loads(pickle.dumps(smaller))
    assert back.vertices.tobytes() == smaller.vertices.tobytes()
    assert back.input_indices.tolist() == smaller.input_indices.tolist()


def test_impossible_offsets_are_refused() -> None:
    plate = ConvexPolyhedron.cuboid([0, 0, 0], [4, 4, 1])
    with pytest.raises(BuildError, match=r"shrunk by 0\.75: it contains no ball.* of radius 0\.5"):
        plate.shrunk(0.75)
    sheet = ConvexPolyhedron.cuboid([0, 0, 0], [4, 4, 0])
    segment = ConvexPolyhedron([[0, 0, 0], [1, 0, 0]])
    for thin in (sheet, segment):
        with pytest.raises(
            BuildError, match=r"shrunk by 0\.125: it contains no ball.* one of radius 0"
        ):
            thin.shrunk(0.125)
        for same, report in (thin.shrunk(0), thin.grown(0)):
            assert same.vertices.tolist() == thin.vertices.tolist()
            assert (report.farthest, report.vanished.tolist()) == (0, [])
    assert sheet.grown(0.5)[0].volume == pytest.approx(5 * 5 * 1, abs=1e-12)
    with pytest.raises(BuildError, match="a body of dimension 1 has no faces"):
        segment.grown(0.125)
    for amount in (-1, np.nan, np.inf):
        for move in (plate.shrunk, plate.grown):
            with pytest.raises(
                BuildError, match="invalid amount (-1|NaN|inf) to shrink or grow by"
            ):
                move(amount)
    with pytest.raises(BuildError, match="not negative, in range"):
        plate.grown(1e75)
    with pytest.raises(TypeError):
        plate.grown("1")  # type: ignore[arg-type]


def flat_cube(depth: float) -> tuple[Any, list[list[int]]]:
    """Returns a unit cube whose lid is a pyramid of four triangles that points inwards."""
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    corners = [[*place, z] for z in (0, 1) for place in square]
    sides = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    lid = [[k + 4, (k + 1) % 4 + 4, 8] for k in range(4)]
    return np.array([*corners, [0.5, 0.5, 1 - depth]]), [[3, 2, 1, 0], *sides, *lid]


def test_answers_report_the_dents_of_meshes_that_are_convex_by_tolerance(tmp_path: Path) -> None:
    vertices, faces = flat_cube(5e-6)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces]
    (tmp_path / "flat.obj").write_text("\n".join(lines))
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    z = [0.0, 0.0, 1.0]
    made = ConvexPolyhedron.from_mesh(vertices, faces, convex_tolerance=1e-5)
    for flat in (made, colltrans.read(tmp_path / "flat.obj")):
        assert flat.dent == pytest.approx(5e-6, abs=1e-12)
        high = Pose([0, 0, 3])
        swept = MotionCast(cube, flat, moving_motion=Motion.slide([0, 0, 9]), fixed_motion=high)
        answers: list[Any] = [
            Cast(cube, flat, z, fixed_pose=high).cast(),
            Cast(cube, flat, z, fixed_pose=high).clearance(),
            colltrans.distance(cube, flat, fixed_pose=high),
            SolidCast(cube, flat, z, fixed_pose=high).clearance(),
            swept.motion(),
        ]
        for answer in answers:
            assert answer.to_dict()["dents"] == {"fixed": flat.dent}, answer
        # A pickled body keeps the dent although its JSON has only the hull.
        again = pickle.loads(pickle.dumps(flat))
        assert again.dent == flat.dent
        assert Cast(flat, cube, z).clearance().to_dict()["dents"] == {"moving": flat.dent}
    assert cube.dent == 0
    assert "dents" not in Cast(cube, cube, z).clearance().to_dict()


def test_a_dent_that_the_precision_of_the_file_explains_is_not_reported(tmp_path: Path) -> None:
    vertices, faces = flat_cube(1.5e-6)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in (vertices + 1 / 3).tolist()]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces]
    (tmp_path / "flat.obj").write_text("\n".join(lines))
    flat = colltrans.read(tmp_path / "flat.obj")
    assert flat.dent == 0
    assert flat.notes == []
    assert "dents" not in Cast(flat, flat, [1, 0, 0]).clearance().to_dict()
