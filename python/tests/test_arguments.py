"""Tests that every array that numpy accepts gives the same bits or is refused with a reason."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

import colltrans
from colltrans import ColltransError, ConvexPolyhedron, InputError, Pose, cast, cast_many
from colltrans.errors import PoseError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
FAR = ConvexPolyhedron.cuboid([9, 9, 9], [10, 10, 10])


def strided(array: NDArray[Any]) -> NDArray[Any]:
    wide = np.zeros((*array.shape, 2), array.dtype)
    wide[..., 0] = array
    return wide[..., 0]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


def unaligned(array: NDArray[Any]) -> NDArray[Any]:
    raw = np.zeros(array.nbytes + 1, np.uint8)
    view = np.frombuffer(raw.data, array.dtype, array.size, 1).reshape(array.shape)
    raw[1:] = np.frombuffer(array.tobytes(), np.uint8)
    return view


FORMS: list[Any] = [
    lambda a: a,
    lambda a: a.astype(np.float32),
    lambda a: a.astype(np.float16),
    lambda a: a.astype(np.longdouble),
    lambda a: a.astype(">f8"),
    lambda a: a.astype(np.int32),
    lambda a: a.astype(">i2"),
    lambda a: np.asfortranarray(a),
    lambda a: a.tolist(),
    lambda a: [np.float64(x) for x in a] if a.ndim == 1 else tuple(map(tuple, a)),
    strided,
    read_only,
    unaligned,
    lambda a: a[::-1].copy()[::-1],
    lambda a: a.view(np.matrix) if a.ndim == 2 else a,
]


SLIDE = colltrans.Motion.slide([0, 0, 3])
ARM = colltrans.Robot.read(Path(__file__).parents[2] / "data/arm.urdf")

#: The same without types, because a type checker rejects the refused calls.
CALLED: Any = colltrans
CALLED_ARM: Any = ARM

#: Calls with an argument that is easily confused, and the accepted forms in the message.
INSTEAD: list[tuple[Callable[[], Any], type[Exception], list[str]]] = [
    (
        lambda: CALLED.motion_many(CUBE, CUBE, [0, 0, 1]),
        TypeError,
        ["moving_motion", "Motion.slide([0.0, 0.0, 1.0])", "Motion.still([0.0, 0.0, 1.0])"],
    ),
    (
        lambda: CALLED.motion_many(CUBE, CUBE, [[0, 0, 1], [0, 0, 2]]),
        TypeError,
        ["moving_motion", '{"slide": {"by": array}}'],
    ),
    (
        lambda: CALLED.motion_many(CUBE, CUBE, {"turn": [1]}),
        InputError,
        ["'turn' takes a dict", "point", "axis", "radians", "not a list"],
    ),
    (lambda: CALLED.motion(CUBE, CUBE, [SLIDE]), InputError, ["motion_many"]),
    (
        lambda: CALLED.Assembly([CUBE]),
        InputError,
        ["parts: a dict", "not a list", "Assembly.read"],
    ),
    (
        lambda: CALLED.Assembly({"a": "cube.obj"}),
        InputError,
        ["parts['a']: a pair (vertices, faces) or a mesh", "not a str"],
    ),
    (
        lambda: CALLED_ARM.first_contact([[0.0] * 3], scene=[CUBE]),
        InputError,
        ["scene: a dict", "not a list"],
    ),
    (lambda: ConvexPolyhedron("cube.obj"), InputError, ["the text", "ConvexPolyhedron.read"]),
    (lambda: CALLED.cast("cube.obj", CUBE, [0, 0, 1]), TypeError, ["ConvexPolyhedron.read(path)"]),
    (lambda: cast(CUBE, CUBE, "z"), InputError, ["direction", "three numbers"]),
    (
        lambda: colltrans.read("part.step"),
        colltrans.errors.MeshError,
        ["part.step", "Assembly.read(path)"],
    ),
    (lambda: colltrans.Solid.read("part.GLB"), colltrans.errors.MeshError, ["Assembly.read(path)"]),
    (
        lambda: colltrans.motions.motion_clearance(CUBE, FAR, SLIDE).save_proof(
            "no/such/proof.json"
        ),
        FileNotFoundError,
        ["no/such/proof.json"],
    ),
]


@pytest.mark.parametrize(("call", "kind", "words"), INSTEAD)
def test_confused_arguments_are_refused_with_the_accepted_forms(
    call: Callable[[], Any], kind: type[Exception], words: list[str]
) -> None:
    with pytest.raises(kind) as refused:
        call()
    for word in words:
        assert word in str(refused.value)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.filterwarnings("ignore:the matrix subclass")
def test_every_form_of_an_array_gives_the_same_answer(form: Any) -> None:
    start, direction = np.array([-3.0, 0, 0]), np.array([2.0, 0, 0])
    turned = np.array([[0.0, -1, 0, -3], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    quaternion = np.array([-3.0, 0, 0, 0, 0, 0, 1])
    for pose in (start, turned, turned[:3], quaternion):
        known = cast(CUBE, CUBE, direction, moving_pose=pose)
        found = cast(CUBE, CUBE, form(direction), moving_pose=form(pose))
        assert repr(found) == repr(known)
        rows = cast_many(CUBE, CUBE, form(direction), moving_pose=form(pose))
        assert len(rows) == 1 and repr(rows[0]) == repr(known)
    rows = cast_many(CUBE, CUBE, form(np.eye(3)), moving_pose=form(np.tile(start, (3, 1))))
    assert len(rows) == 3
    assert ConvexPolyhedron(form(CUBE.vertices)).volume == 1.0
    square = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    corners = np.vstack([np.zeros(3), np.eye(3)])
    assert ConvexPolyhedron.from_mesh(form(corners), square).volume == 1 / 6


MATRICES = [np.eye(3, 4), np.eye(4)]


@pytest.mark.parametrize("matrix", MATRICES)
def test_matrices_are_read_entry_by_entry(matrix: NDArray[Any]) -> None:
    random = np.random.default_rng(3)
    for _ in range(50):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        matrix[:3, :3] = turn * np.sign(np.linalg.det(turn))
        matrix[:3, 3] = random.normal(size=3)
        pose = Pose(matrix)
        assert np.array_equal(pose.as_matrix()[:3], matrix[:3])
        assert np.array_equal(pose.rotation, matrix[:3, :3])
        one = cast(CUBE, CUBE, [0, 0, 1], moving_pose=matrix)
        many = cast_many(CUBE, CUBE, [0, 0, 1], moving_pose=matrix[None])
        assert repr(one) == repr(many[0]) == repr(cast(CUBE, CUBE, [0, 0, 1], moving_pose=pose))


def test_objects_with_a_matrix_are_accepted_as_poses() -> None:
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    whole = np.eye(4)
    whole[:3, :3] = turn
    known = cast(CUBE, CUBE, [1, 0, 0], moving_pose=whole)
    for matrix in (turn, whole):
        thing = SimpleNamespace(as_matrix=lambda matrix=matrix: matrix)
        assert repr(cast(CUBE, CUBE, [1, 0, 0], moving_pose=thing)) == repr(known)
        assert repr(cast_many(CUBE, CUBE, [1, 0, 0], moving_pose=thing)[0]) == repr(known)
        stack = SimpleNamespace(as_matrix=lambda matrix=matrix: np.stack([matrix] * 5))
        assert repr(cast_many(CUBE, CUBE, [1, 0, 0], moving_pose=stack)[4]) == repr(known)


def test_scipy_rotations_are_accepted_as_poses() -> None:
    transform = pytest.importorskip("scipy.spatial.transform")
    turns = transform.Rotation.random(20, random_state=1)
    rows = cast_many(CUBE, CUBE, [0, 0, 1], moving_pose=turns)
    for i in range(20):
        assert repr(rows[i]) == repr(cast(CUBE, CUBE, [0, 0, 1], moving_pose=turns[i]))


def test_a_pose_times_its_inverse_is_the_identity() -> None:
    pose = Pose([1, 2, 3, 0, 0, 0.6, 0.8])
    assert np.allclose((pose @ pose.inverse()).as_matrix(), np.eye(4), atol=1e-15)
    assert np.array_equal(Pose(pose).as_matrix(), pose.as_matrix())
    assert Pose() == Pose([0, 0, 0]) == Pose(np.eye(4))


REFUSED: list[Any] = [
    None,
    "north",
    object(),
    {1, 2, 3},
    [],
    [1, 2],
    [1, 2, 3, 4],
    [[1, 2, 3]],
    ["1", "2", "3"],
    [1, 2, "3"],
    [1j, 0, 0],
    [True, False, False],
    [[1], [2, 3], [4]],
    np.zeros((3, 0)),
    np.zeros((0, 3)),
    np.zeros((2, 3, 4, 5)),
    np.array(["a", "b", "c"]),
    np.array([1, 2, 3], object),
    np.array([1, 2, 3], "M8[s]"),
    np.float64(1),
    10**400,
    [10**400, 0, 0],
]


@pytest.mark.parametrize("direction", REFUSED)
def test_invalid_vectors_are_refused(direction: Any) -> None:
    with pytest.raises(InputError, match="direction"):
        cast(CUBE, CUBE, direction)


@pytest.mark.parametrize("pose", [p for p in REFUSED if p is not None])
def test_invalid_poses_are_refused(pose: Any) -> None:
    with pytest.raises(InputError, match="moving_pose"):
        cast(CUBE, CUBE, [1, 0, 0], moving_pose=pose)
    with pytest.raises(InputError, match="source"):
        Pose(pose)


def test_invalid_rotations_are_refused_with_the_message_of_the_library() -> None:
    with pytest.raises(PoseError, match="has length 2, not 1"):
        Pose([0, 0, 0, 0, 0, 0, 2])
    with pytest.raises(PoseError, match="is not a rotation"):
        Pose(-np.eye(4) + np.diag([0, 0, 0, 2]))
    with pytest.raises(InputError, match="last row"):
        Pose(np.ones((4, 4)))
    with pytest.raises(PoseError, match="not finite"):
        Pose([np.nan, 0, 0])
    with pytest.raises(InputError, match=r"shape \(2, 3\), not .*\(3, 3\)"):
        Pose(np.eye(2, 3))


def test_an_array_of_three_rows_is_a_rotation_unless_rows_are_taken() -> None:
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    pose = Pose(turn)
    assert np.array_equal(pose.rotation, turn) and not pose.translation.any()
    with pytest.raises(PoseError, match="is not a rotation"):
        Pose(np.zeros((3, 3)))
    whole = np.eye(4)
    whole[:3, :3] = turn
    known = cast(CUBE, CUBE, [1, 0, 0], moving_pose=whole)
    assert repr(cast(CUBE, CUBE, [1, 0, 0], moving_pose=turn)) == repr(known)
    rows = cast_many(CUBE, CUBE, [1, 0, 0], moving_pose=np.stack([turn] * 4))
    assert [repr(row) for row in rows.answers()] == [repr(known)] * 4
    with pytest.raises(InputError, match=r"\(3, 3\) is ambiguous.*Pose\(matrix\)"):
        cast_many(CUBE, CUBE, [1, 0, 0], moving_pose=turn)


ANYTHING = arrays.arrays(
    dtype=st.one_of(
        arrays.floating_dtypes(endianness="?"),
        arrays.integer_dtypes(endianness="?"),
        arrays.unsigned_integer_dtypes(endianness="?"),
        arrays.complex_number_dtypes(),
        arrays.boolean_dtypes(),
        arrays.unicode_string_dtypes(),
    ),
    shape=arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
)
DIMENSIONS = st.sampled_from([(3,), (7,), (3, 4), (4, 4), (5, 3), (5, 7), (5, 4, 4)])
NUMBERS = arrays.arrays(
    dtype=st.sampled_from(["<f8", ">f8", "<f4", ">f4", "<i4"]),
    shape=DIMENSIONS,
    elements=st.integers(-3, 3),
)


def accept(array: NDArray[Any], ways: int) -> NDArray[Any]:
    if ways & 1 and array.ndim:
        array = array[..., ::-1][..., ::-1]
    if ways & 2:
        array = np.asfortranarray(array)
    if ways & 4:
        array = read_only(array)
    return array


@given(ANYTHING | NUMBERS, ANYTHING | NUMBERS, st.integers(0, 7))
def test_any_argument_gives_an_answer_or_a_colltrans_error(
    direction: NDArray[Any], pose: NDArray[Any], ways: int
) -> None:
    direction, pose = accept(direction, ways), accept(pose, ways)
    for question in (colltrans.cast, colltrans.cast_many, colltrans.clearance_many):
        try:
            answer = question(CUBE, CUBE, direction, moving_pose=pose)
        except ColltransError as error:
            assert str(error)
        else:
            assert repr(answer)
    try:
        assert ConvexPolyhedron(pose).vertices.shape[1] == 3
    except ColltransError as error:
        assert str(error)


@given(ANYTHING)
def test_faces_of_any_type_are_read_or_refused(faces: NDArray[Any]) -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    for form in (faces, faces.tolist()):
        try:
            ConvexPolyhedron.from_mesh(corners, form)
        except ColltransError as error:
            assert str(error)
