"""Tests what all questions share: bodies of both kinds, poses, numbers of answers, names."""

import importlib
import math
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import colltrans
from colltrans import ConvexPolyhedron, InputError, Motion, Pair, Pose, Solid, SolidCast

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
BOX = Solid.from_pieces([CUBE])
BALL = ConvexPolyhedron.sphere(0.5, center=[0.5, 0.5, 0.5])
ROUND = BOX.rounded(0.25)
AHEAD = [1.0, 0, 0]
START = [-3, 0.25, 0.125]
KINDS: dict[str, Any] = {"convex": CUBE, "solid": BOX, "ball": BALL, "rounded solid": ROUND}
EXTRA: dict[str, list[Any]] = {"cast": [AHEAD], "clearance": [AHEAD], "within": [1.0]}
PAIRS = [(a, b) for a in KINDS for b in KINDS]


def ask(name: str, moving: Any, fixed: Any, **more: Any) -> Any:
    """Asks one of the seven questions about a body at START (or more) and a fixed one."""
    question = getattr(colltrans, name)
    if name.startswith("motion"):
        slide = Motion.slide([8, 0, 0], pose=START)
        return question(moving, fixed, slide)
    given: list[Any] = EXTRA.get(name.split("_")[0], [])
    return question(moving, fixed, *given, **{"moving_pose": START, **more})


QUESTIONS = ["cast", "clearance", "distance", "depth", "within", "intersects", "motion"]


@pytest.mark.parametrize("name", QUESTIONS)
@pytest.mark.parametrize("pair", PAIRS, ids=" and ".join)
def test_every_question_takes_every_kind_of_body_alone_and_in_rows(
    name: str, pair: tuple[str, str]
) -> None:
    moving, fixed = (KINDS[kind] for kind in pair)
    # Both balls are met beside their poles.
    if pair == ("ball", "ball"):
        fixed = CUBE
    gap = 2 - moving.radius * (moving is ROUND) - fixed.radius * (fixed is ROUND)
    alone = ask(name, moving, fixed)
    rows: Any = ask(f"{name}_many", moving, fixed)
    assert issubclass(type(rows), colltrans.columns.Table)
    assert len(rows) == 1 and not rows.errors
    if name in ("within", "intersects"):
        assert bool(alone) is False
        assert rows.outcome[0] in ("farther", "apart")
        return
    expected = {"depth": 0.0, "motion": gap / 8}.get(name, gap)
    assert alone.lower - 1e-9 <= expected <= alone.upper + 1e-9
    assert alone.value == pytest.approx(expected, abs=1e-9) == float(alone)
    assert rows.value[0] == pytest.approx(alone.value, abs=1e-12)
    assert rows.lower[0] == alone.lower and rows.upper[0] == alone.upper


@pytest.mark.parametrize("name", QUESTIONS[:-1])
def test_methods_of_queries_have_the_names_of_the_functions(name: str) -> None:
    length = [1.0] if name == "within" else []
    if name in ("cast", "clearance"):
        queries: list[Any] = [
            colltrans.Cast(CUBE, CUBE, AHEAD, moving_pose=START),
            SolidCast(BOX, CUBE, AHEAD, moving_pose=START),
        ]
    else:
        queries = [Pair(CUBE, CUBE, moving_pose=START), Pair(BOX, CUBE, moving_pose=START)]
    for query in queries:
        answer = getattr(query, name)(*length)
        assert repr(answer) == repr(ask(name, query.moving, query.fixed))


def test_solids_behind_and_beside_the_body_are_cast_like_convex_ones() -> None:
    behind: Any = colltrans.cast(BOX, CUBE, AHEAD, moving_pose=[5, 0.25, 0])
    assert isinstance(behind, colltrans.SolidContact)
    assert behind.value == pytest.approx(-6) and behind.lower <= -6 <= behind.upper
    with pytest.raises(colltrans.errors.CaseError, match="behind the start"):
        behind.to_dict()
    beside: Any = colltrans.cast(BOX, CUBE, AHEAD, moving_pose=[-3, 7, 0])
    assert isinstance(beside, colltrans.SolidFree) and float(beside) == math.inf
    starts = [[5, 0.25, 0], [-3, 7, 0], [-3, 0.25, 0], [math.nan, 0, 0]]
    rows: Any = colltrans.cast_many([BOX, CUBE, BOX, BOX], CUBE, AHEAD, moving_pose=starts)
    assert rows.outcome.tolist() == ["contact", "free", "contact", "error"]
    assert rows.value.tolist()[:3] == [behind.value, math.inf, pytest.approx(2)]
    assert repr(rows[0]) == repr(behind)


def test_depths_of_solids_are_bounds_of_a_translation() -> None:
    found: Any = colltrans.depth(BOX, CUBE, fixed_pose=[0.75, 0.5, 0.5])
    assert found.lower <= 0.25 <= found.upper and 0.2 < found < 0.3
    rows = colltrans.depth_many(BOX, CUBE, fixed_pose=[[0.75, 0.5, 0.5], [3, 0, 0]])
    assert (rows.lower[0], rows.upper[0]) == (found.lower, found.upper)
    assert rows.value[1] == 0 and repr(rows[0]) == repr(found)


def test_answers_compare_with_numbers_and_order_among_each_other() -> None:
    near: Any = colltrans.clearance(CUBE, CUBE, AHEAD, moving_pose=[-2, 0, 0])
    far: Any = colltrans.clearance(CUBE, CUBE, AHEAD, moving_pose=[-4, 0, 0])
    free: Any = colltrans.clearance(CUBE, CUBE, AHEAD, moving_pose=[-4, 5, 0])
    assert near < 1.5 < far < free and near <= near.value <= 1 and far >= far.value
    assert not near > 1.5 and sorted([free, far, near]) == [near, far, free]
    assert near == near.value and near != 7 and near == np.float64(near.value) and free == math.inf
    again = colltrans.clearance(CUBE, CUBE, AHEAD, moving_pose=[-2, 0, 0])
    assert near == near and near != again and len({near, again}) == 2
    assert (np.array([0.5, 1.5]) > near).tolist() == [False, True]
    with pytest.raises(TypeError):
        near < "1"  # noqa: B015
    over: Any = colltrans.clearance(CUBE, CUBE, AHEAD, moving_pose=[0.5, 0, 0])
    assert over.value is None and over != 0
    for call in (lambda: float(over), lambda: over < 1, lambda: near < over):
        with pytest.raises(TypeError, match="Overlapping has no number"):
            call()


def test_times_of_motions_are_numbers_too() -> None:
    def moved(by: list[float], fixed: Any = CUBE) -> Any:
        return colltrans.motion(CUBE, fixed, Motion.slide(by, pose=START))

    free, hit = moved([0, 0, 9]), moved([8, 0, 0])
    assert (free.outcome, free.lower, free.upper, free.value) == ("free", 1.0, math.inf, math.inf)
    assert hit.lower <= 0.25 <= hit.upper and 0.2 < hit < 0.3 and hit < free
    cleared = colltrans.motions.motion_clearance(CUBE, CUBE, Motion.slide([0, 0, 9], pose=START))
    assert (cleared.value, cleared.upper) == (1.0, 1.0)
    slides = {"slide": {"by": [[0, 0, 9], [8, 0, 0]]}}
    rows = colltrans.motion_many(CUBE, CUBE, slides, moving_pose=START)
    assert rows.value.tolist() == [math.inf, hit.value]


def test_placed_bodies_replace_bodies_with_poses() -> None:
    placed = CUBE.at(START)
    assert placed.body is CUBE and placed.pose == Pose(START)
    for name in QUESTIONS[:-1]:
        given = EXTRA.get(name, [])
        for body in (CUBE, BOX):
            answer = getattr(colltrans, name)(body.at(START), CUBE, *given)
            assert repr(answer) == repr(ask(name, body, CUBE))
    rows = colltrans.cast_many([CUBE.at(START), CUBE.at([-4, 0, 0])], CUBE.at([1, 0, 0]), AHEAD)
    assert rows.translation.tolist() == [3.0, 4.0]
    resting = colltrans.motion(CUBE, CUBE.at([5, 0, 0]), Motion.slide([8, 0, 0]))
    assert resting.lower <= 0.5 <= resting.upper
    with pytest.raises(InputError, match="moving has a pose already"):
        colltrans.cast(placed, CUBE, AHEAD, moving_pose=START)
    with pytest.raises(InputError, match="moving has a pose already"):
        colltrans.cast_many([placed], CUBE, AHEAD, moving_pose=START)
    with pytest.raises(InputError, match="either all bodies"):
        colltrans.cast_many([placed, CUBE], CUBE, AHEAD)
    with pytest.raises(InputError, match="moving has a pose already"):
        colltrans.motion(placed, CUBE, Motion.slide([8, 0, 0]))


TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
QUATERNION = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))


def test_poses_of_other_packages_are_read() -> None:
    homogeneous = np.eye(4)
    homogeneous[:3, :3], homogeneous[:3, 3] = TURN, START
    pair = (tuple(START), QUATERNION)
    ours = [Pose(homogeneous), Pose(homogeneous[:3]), Pose(pair), Pose(list(map(list, pair)))]
    for pose in ours:
        assert np.allclose(pose.as_matrix(), homogeneous)
    assert np.array_equal(Pose(TURN).rotation, TURN) and not Pose(TURN).translation.any()
    forms: list[Any] = [
        ours,
        np.stack([homogeneous] * 4),
        [homogeneous] * 4,
        [pair] * 4,
        (np.array([START] * 4), np.array([QUATERNION] * 4)),
        (np.array([START] * 4), QUATERNION),
        (START, np.array([QUATERNION] * 4)),
    ]
    for form in forms:
        rows = colltrans.distance_many(CUBE, CUBE, moving_pose=form)
        assert len(rows) == 4 and np.allclose(rows.value, rows.value[0]), form
        assert rows.value[0] == pytest.approx(3)
        assert len(colltrans.Obstacles().add_many(CUBE, form)) == 4
    assert len(colltrans.distance_many(CUBE, CUBE, moving_pose=pair)) == 1
    turns = colltrans.distance_many(CUBE, CUBE, moving_pose=np.stack([TURN] * 5), fixed_pose=AHEAD)
    assert len(turns) == 5 and turns.value.tolist() == pytest.approx([1] * 5)


def test_a_rotation_in_place_of_three_translations_is_ambiguous() -> None:
    with pytest.raises(InputError, match="one rotation or three translations"):
        colltrans.cast_many(CUBE, CUBE, AHEAD, moving_pose=TURN)
    three = colltrans.cast_many(CUBE, CUBE, AHEAD, moving_pose=[START, [-4, 0, 0], [-5, 0, 0]])
    assert three.translation.tolist() == [2, 3, 4]


def test_rotations_of_scipy_are_read_alone_and_in_stacks() -> None:
    rotations = pytest.importorskip("scipy.spatial.transform").Rotation
    turn = rotations.from_matrix(TURN)
    assert np.allclose(Pose(turn).rotation, TURN)
    stack = rotations.from_matrix(np.stack([TURN] * 3))
    assert len(colltrans.distance_many(CUBE, CUBE, moving_pose=stack, fixed_pose=[5, 0, 0])) == 3
    assert len(colltrans.distance_many(CUBE, CUBE, moving_pose=[turn, turn])) == 2


class Vectors:
    """Vectors as open3d has them: neither an array nor a sequence of Python."""

    def __init__(self, rows: Any) -> None:
        self.rows = rows

    def __len__(self) -> int:
        return len(self.rows)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.array(self.rows, dtype)


def test_meshes_of_other_packages_are_read() -> None:
    vertices, triangles = CUBE.vertices, CUBE.triangles
    meshes: list[Any] = [
        SimpleNamespace(vertices=vertices, faces=triangles),
        SimpleNamespace(vertices=Vectors(vertices), triangles=Vectors(triangles)),
        CUBE,
    ]
    for mesh in meshes:
        for body in (Solid(mesh), ConvexPolyhedron(mesh), ConvexPolyhedron.from_mesh(mesh)):
            assert body.volume == pytest.approx(1) and body.bounds.tolist() == [
                [0, 0, 0],
                [1, 1, 1],
            ]
            assert body.triangles.shape == (12, 3) and body.vertices.shape == (8, 3)
    trimesh = pytest.importorskip("trimesh")
    assert Solid(trimesh.creation.box()).volume == pytest.approx(1)


def test_bounds_contain_the_radius() -> None:
    for body in (CUBE.rounded(0.5), BOX.rounded(0.5)):
        assert body.bounds.tolist() == [[-0.5] * 3, [1.5] * 3]
        assert len(body.vertices) == 8 and len(body.triangles) == 12
    plane = Solid(CUBE).volume, ConvexPolyhedron.read(Path(ROOT / "data/plate.off"), hull=True)
    assert plane[0] == pytest.approx(1) and plane[1].volume > 0


def test_data_frames_have_the_columns() -> None:
    rows = colltrans.cast_many(CUBE, CUBE, AHEAD, moving_pose=[START, [-4, 9, 0], [math.nan] * 3])
    names = ["outcome", "translation", "normal_x", "point_z", "message"]
    first = next(iter(rows))
    assert first.outcome == "contact" and first.translation == 2.0
    answers: list[Any] = list(rows[:2].answers())
    assert [answer.value for answer in answers] == [2.0, math.inf]
    assert rows["translation"] is rows.translation
    with pytest.raises(InputError, match="unknown column 'distance'"):
        rows["distance"]
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(rows)
    assert set(names) <= set(frame.columns) == set(rows.to_pandas().columns)
    assert frame.translation.tolist()[0] == 2.0 and frame.outcome.tolist()[1] == "separated"
    assert "moving_pose" in frame.message[2]


def test_data_frames_of_polars_have_the_columns() -> None:
    polars = pytest.importorskip("polars")
    rows = colltrans.cast_many(CUBE, CUBE, AHEAD, moving_pose=[START, [-4, 9, 0]])
    frame = polars.DataFrame(rows)
    assert frame.columns[:2] == ["outcome", "translation"] and frame["translation"][0] == 2.0


def test_the_top_level_is_small_and_old_names_tell_their_new_place() -> None:
    assert len(colltrans.__all__) <= 60
    assert len((colltrans.__doc__ or "").splitlines()) <= 60
    table = (ROOT / "MIGRATION.md").read_text()
    for name, module in {**colltrans._MOVED, "first_contact": ""}.items():
        new = colltrans._moved(name)
        assert new is not None and f"`{name}`" in table
        found = importlib.import_module("colltrans")
        for part in new.split(".")[1:]:
            found = getattr(found, part)
        assert callable(found), new
        if module:
            assert name in importlib.import_module(f"colltrans.{module}").__all__, name
        with pytest.raises(AttributeError, match=f"colltrans.{name} is now {new}"):
            getattr(colltrans, name)
        assert not hasattr(colltrans, name)
    code = "from colltrans import audit"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "ImportError: colltrans.audit is now colltrans.assembly.audit" in told.stderr
    with pytest.raises(AttributeError, match="has no attribute 'no_such'"):
        colltrans.no_such  # noqa: B018
