"""Tests parts that are not convex: bits of the command line, proofs, refusals, copies."""

import copy
import pickle
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT, Batch

from colltrans import (
    ConvexPolyhedron,
    InputError,
    OverlapDepth,
    Pair,
    Solid,
    SolidBlocked,
    SolidCast,
    SolidFree,
    SolidOverlapping,
)
from colltrans.answers import ShrinkReport, SolidCertificate
from colltrans.errors import BuildError, CertificateError, MeshError, QueryError

PARTS = ROOT / "data"
CORNERS = np.vstack([np.zeros(3), np.eye(3)])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


@pytest.fixture(scope="module")
def bolt() -> Solid:
    return Solid.read(PARTS / "bolt.stl")


@pytest.fixture(scope="module")
def plate() -> Solid:
    return Solid.read(PARTS / "plate.off")


def test_answers_equal_those_of_the_command_line(batch: Batch, bolt: Solid, plate: Solid) -> None:
    random = np.random.default_rng(30)
    turns = random.normal(size=(60, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    turns[:20] = [0, 0, 0, 1]
    starts = random.uniform(-1, 1, size=(60, 3)) * [6, 6, 9]
    starts[:10] = [0, 0, 7]
    directions = random.normal(size=(60, 3))
    directions[:20] = [0, 0, -1]
    lines = batch(
        {
            "moving": {"solid": str(PARTS / "bolt.stl")},
            "fixed": {"solid": str(PARTS / "plate.off")},
            "moving_pose": {"translation": start.tolist(), "rotation": turn.tolist()},
            "direction": direction.tolist(),
            "tolerance": 1e-6,
        }
        for start, turn, direction in zip(starts, turns, directions, strict=True)
    )
    outcomes = set()
    for i, line in enumerate(lines):
        query = SolidCast(
            bolt, plate, directions[i], moving_pose=np.r_[starts[i], turns[i]], tolerance=1e-6
        )
        outcomes.add(line["outcome"])
        assert query.tolerance == line["tolerance"]
        match query.clearance():
            case SolidBlocked(distance, contact):
                assert (line["outcome"], line["distance"]) == ("blocked", distance)
                assert line["translation"] == contact.translation
                assert line["translation_bounds"] == list(contact.translation_bounds)
                assert line["offset_distance"] == contact.offset_distance
                assert line["offset_distance_bounds"] == list(contact.offset_distance_bounds)
                for side in ("moving", "fixed"):
                    feature = getattr(contact, f"{side}_feature")
                    known = {"kind": feature.kind, "vertices": feature.vertices.tolist()}
                    assert line["features"][side] == known
                assert line["normal"] == contact.normal.tolist()
                assert line["point"] == contact.point.tolist()
            case SolidFree():
                assert line["outcome"] == "free"
            case SolidOverlapping():
                assert line["outcome"] == "overlapping"
    assert outcomes == {"blocked", "free", "overlapping"}


def test_proofs_are_checked_and_saved(bolt: Solid, plate: Solid) -> None:
    query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 7])
    answer, proof = query.certified_clearance()
    assert isinstance(answer, SolidBlocked) and repr(answer) == repr(query.clearance())
    assert answer.contact.translation == 7 and 7 - 1e-11 < answer.distance <= 7
    assert repr(answer) == f"SolidBlocked(distance={answer.distance!r})"
    again = SolidCertificate.from_json(proof.to_json())
    assert query.verify(again) == query.verify(proof) < 1e-11
    # The values of the shrunk bodies: the tolerance follows the single precision of the file.
    assert 7 + query.tolerance - 1e-11 < proof.lower <= answer.contact.offset_distance
    nearer = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 6])
    with pytest.raises(CertificateError):
        nearer.verify(proof)


def test_other_questions(bolt: Solid, plate: Solid) -> None:
    query = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[0, 0, 7])
    lower, upper = query.exit_bounds() or (0, 0)
    assert lower <= 12 <= upper < 12 + 1e-11
    assert query.exit() == 12 and query.least_tolerance() == 0 and not query.intersects()
    assert isinstance(query.reversed().clearance(), SolidFree)
    inside = SolidCast(bolt, plate, [0, 0, -1], moving_pose=[3, 0, 0])
    match inside.clearance():
        case SolidOverlapping(least_tolerance=least):
            assert least == inside.least_tolerance() and least is not None and least > 0
        case other:
            raise AssertionError(other)
    assert inside.intersects()
    assert query.moving is bolt and query.moving_pose.translation.tolist() == [0, 0, 7]


def test_ignored_overlaps_are_reported() -> None:
    table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
    plate = ConvexPolyhedron.cuboid([0, 0, 0], [1, 2, 1])
    pressed = SolidCast(
        plate, table, [1, 0, 0], moving_pose=[0, 0, -0.125], ignore_start_overlaps=True
    )
    assert isinstance(pressed.clearance(), SolidFree)
    ignored = pressed.start_overlap()
    assert ignored is not None and ignored.query is pressed
    assert ignored.least_tolerance == pytest.approx(0.125, abs=1e-9)
    moving, fixed = ignored.place
    assert moving is not None and fixed is not None
    assert moving < len(plate.faces) and table.face_normal(fixed).tolist() == [0, 0, 1]
    assert SolidCast(plate, table, [1, 0, 0]).start_overlap() is None
    small = ConvexPolyhedron.cuboid([0, 0, 0], [0.25, 0.25, 0.25])
    within = SolidCast(small, table, [1, 0, 0], moving_pose=[0, 0, -0.5]).start_overlap()
    assert within is not None and within.place[1] is None
    assert (within.place[0] or 0) < len(small.faces)
    around = SolidCast(table, small, [1, 0, 0], fixed_pose=[0, 0, -0.5]).clearance()
    assert isinstance(around, SolidOverlapping) and around.place[0] is None
    assert around.place[1] is not None


def test_a_solid_shrinks_and_grows() -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    post = ConvexPolyhedron.cuboid([2, 2, 0], [3, 3, 4])
    both = Solid.from_pieces([cube, post])
    for (body, report), by in [(both.shrunk(0.25), 0.25), (both.grown(0.25), -0.25)]:
        side = 1 - 2 * by
        assert body.volume == pytest.approx(side**2 * (side + 4 - 2 * by), abs=1e-12)
        assert body.bounds.tolist() == [[by, by, by], [3 - by, 3 - by, 4 - by]]
        assert np.array_equal(body.triangles, both.triangles)
        assert np.array_equal(body.input_indices, both.input_indices)
        assert np.array_equal(body.face_indices, both.face_indices)
        match report:
            case ShrinkReport(farthest, stuck, inverted):
                assert farthest == pytest.approx(0.25 * 3**0.5, abs=1e-12)
                assert stuck.tolist() == inverted.tolist() == []
            case other:
                raise AssertionError(other)
        for again in (pickle.loads(pickle.dumps(body)), copy.deepcopy(body)):
            assert again.vertices.tobytes() == body.vertices.tobytes()
            assert again.face_indices.tolist() == body.face_indices.tolist()
        assert repr(pickle.loads(pickle.dumps(report))) == repr(report)
    wall = Solid.from_pieces([cube, ConvexPolyhedron.cuboid([2, 0, 0], [2.25, 3, 3])])
    _, report = wall.shrunk(0.25)
    assert set(report.inverted.tolist()) <= set(range(6, 12)) and len(report.inverted) > 0
    with pytest.raises(BuildError):
        both.shrunk(-1)


def test_a_union_of_convex_bodies_and_a_convex_body() -> None:
    cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
    post = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])
    step = Solid.from_pieces([cube, post])
    answer = SolidCast(cube, step, [0, 0, -1], moving_pose=[0.5, 0.5, 6]).clearance()
    assert isinstance(answer, SolidBlocked) and answer.contact.translation == 2
    assert 2 - 1e-10 < answer.distance <= 2
    assert answer.contact.fixed_feature.kind in {"face", "vertex", "edge"}
    assert answer.contact.normal.tolist() == [0, 0, -1]
    segment = ConvexPolyhedron([[0, 0, 0], [1, 0, 0]])
    assert SolidCast(segment, step, [0, 0, -1]) is not None


def test_meshes_in_every_form_are_read_and_invalid_ones_refused(tmp_path: Path) -> None:
    for faces in (FACES, FACES.tolist(), FACES.astype(np.uint8)):
        assert Solid(CORNERS.astype("f4"), faces).volume == 1 / 6
    mesh = SimpleNamespace(vertices=CORNERS, faces=FACES)
    assert Solid(mesh).bounds.tolist() == [[0, 0, 0], [1, 1, 1]]
    assert ConvexPolyhedron.from_mesh(mesh).volume == 1 / 6
    for build in (Solid, ConvexPolyhedron.from_mesh):
        with pytest.raises(InputError, match="faces: they are missing"):
            build(CORNERS)
    with pytest.raises(BuildError, match="not closed"):
        Solid(CORNERS, FACES[:3])
    assert not Solid(CORNERS, FACES[:3], open=True).is_closed
    with pytest.raises(MeshError, match="none.stl"):
        Solid.read(tmp_path / "none.stl")
    with pytest.raises(TypeError):
        Solid.from_pieces(["cube"])  # type: ignore[list-item]
    solid = Solid(CORNERS, FACES)
    with pytest.raises(QueryError, match="the tolerance -1 is negative"):
        SolidCast(solid, solid, [1, 0, 0], tolerance=-1)
    with pytest.raises(QueryError, match="direction"):
        SolidCast(solid, solid, [0, 0, 0])


def test_solids_pickle_with_the_same_bits(bolt: Solid, plate: Solid) -> None:
    union = Solid.from_pieces([bolt, ConvexPolyhedron.cuboid([0, 0, 9], [1, 1, 10])])
    scan = Solid(CORNERS, FACES[:3], open=True)
    for solid in (bolt, plate, union, scan):
        again = pickle.loads(pickle.dumps(solid))
        assert np.array_equal(again.vertices, solid.vertices)
        assert np.array_equal(again.triangles, solid.triangles)
        assert np.array_equal(again.face_indices, solid.face_indices)
        assert again.is_closed == solid.is_closed


def box_distance(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Returns the signed distances of points from the surface of a box, by its closed form."""
    beyond = np.maximum(low - points, points - high)
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=-1)
    return np.asarray(np.where(beyond.max(axis=-1) < 0, beyond.max(axis=-1), outside))


def test_signed_distances_agree_with_closed_forms() -> None:
    random = np.random.default_rng(58)
    solid = Solid.from_pieces([ConvexPolyhedron.cuboid([0, 0, 0], [3, 2, 1])])
    points = random.uniform(-2, 5, (500, 3))
    moved = np.array([10.0, -4.0, 0.5])
    found = solid.signed_distances(points + moved, moved)
    exact = box_distance(points, np.zeros(3), np.array([3.0, 2.0, 1.0]))
    assert found.shape == (500, 2) and 5 < (exact < 0).sum() < 495
    assert (found[:, 0] <= exact + 1e-14).all() and (exact - 1e-14 <= found[:, 1]).all()
    assert (found[:, 1] - found[:, 0] < 1e-12).all()
    assert solid.signed_distances(np.empty((0, 3))).shape == (0, 2)
    with pytest.raises(InputError, match="points"):
        solid.signed_distances([1.0, 2.0])
    with pytest.raises(QueryError, match="point 1"):
        solid.signed_distances([[0.0, 0.0, 0.0], [0.0, np.inf, 0.0]])
    with pytest.raises(QueryError, match="round"):
        solid.rounded(0.5).signed_distances([[0, 0, 0]])


def test_surface_distances_are_the_walls_around_nested_bodies() -> None:
    random = np.random.default_rng(7)
    outer = Solid.from_pieces([ConvexPolyhedron.cuboid([0, 0, 0], [8, 8, 8])])
    for _ in range(50):
        low, high = np.sort(random.uniform(0.5, 7.5, (2, 3)), axis=0)
        pair = Pair(ConvexPolyhedron.cuboid(low, high), outer)
        lower, upper = pair.surface_distance()
        wall = min(low.min(), (8 - high).min())
        assert lower <= wall + 1e-14 and wall - 1e-14 <= upper and upper - lower < 1e-12
        assert pair.distance().upper == 0


def test_depth_of_solids_has_the_translation_that_separates_them() -> None:
    post = Solid.from_pieces([ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 4])])
    steps = [([0, 0, 0], [4, 2, 1]), ([0, 0, 0], [2, 2, 3])]
    step = Solid.from_pieces([ConvexPolyhedron.cuboid(*corners) for corners in steps])
    place = np.array([3, 0.5, 0.5])
    found = Pair(post, step, moving_pose=place).depth()
    assert isinstance(found, OverlapDepth)
    assert found.lower <= 0.5 <= found.upper < 0.5 + 1e-9
    assert np.allclose(found.translation, [0, 0, 0.5], atol=1e-9)
    assert np.allclose(found.direction, [0, 0, 1])
    away = Pair(post, step, moving_pose=place + found.translation).depth()
    assert isinstance(away, OverlapDepth) and away.least_tolerance == 0
    record = found.to_dict()
    assert record["separating_translation"] == found.translation.tolist()
    assert (record["lower"], record["upper"]) == (found.lower, found.upper)
