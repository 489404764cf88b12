"""Tests first calls: arguments that are easily confused, and missing files."""

import errno
import math
import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import colltrans
from colltrans import (
    Assembly,
    Cast,
    ConvexPolyhedron,
    InputError,
    Motion,
    MotionCast,
    Pose,
    Robot,
    Solid,
    Tracker,
    cast,
    cast_many,
    clearance,
    contact_range,
    directional_depth,
    motion_many,
)
from colltrans.errors import BuildError, PoseError, RoundedPoseWarning
from colltrans.motions import motion_clearance

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
L_OFF = """OFF
12 8 0
0 0 0
2 0 0
2 1 0
1 1 0
1 2 0
0 2 0
0 0 1
2 0 1
2 1 1
1 1 1
1 2 1
0 2 1
6 5 4 3 2 1 0
6 6 7 8 9 10 11
4 0 1 7 6
4 1 2 8 7
4 2 3 9 8
4 3 4 10 9
4 4 5 11 10
4 5 0 6 11
"""


@pytest.mark.parametrize("vector", [[0, 0, 1], (0.0, 0.0, 1.0), np.array([0, 0, 1], np.float32)])
def test_three_numbers_in_place_of_a_motion_are_refused_with_both_calls(vector: Any) -> None:
    above = Motion.slide([0, 0, 5], pose=[0, 0, -9])
    for question in (colltrans.motion, motion_clearance, MotionCast):
        for motions in ((vector, None), (above, vector)):
            named = dict(zip(("moving_motion", "fixed_motion"), motions, strict=True))
            with pytest.raises(
                InputError, match="could be a displacement or a position"
            ) as refused:
                question(CUBE, CUBE, **named)
            assert "Motion.slide([0.0, 0.0, 1.0])" in str(refused.value)
            assert "Motion.still([0.0, 0.0, 1.0])" in str(refused.value)
    assert colltrans.motion(CUBE, CUBE, above, Pose([0, 0, 1])).outcome == "free"


def test_an_angle_without_its_unit_is_refused_with_the_call() -> None:
    point, axis = [0, 0, 0], [0, 0, 1]
    turn: Any = Motion.turn
    with pytest.raises(
        InputError, match=r"call Motion.turn\(point, axis, degrees=90\) or .*radians"
    ):
        turn(point, axis, 90)
    with pytest.raises(InputError, match="it is missing"):
        Motion.turn(point, axis)
    with pytest.raises(InputError, match="it has two units"):
        Motion.turn(point, axis, degrees=1, radians=1)
    screw: Any = Motion.screw
    with pytest.raises(InputError, match="it has no unit"):
        screw(point, axis, 90, rise=1)
    with pytest.raises(InputError, match="'turn' has point, axis, radians"):
        motion_many(CUBE, CUBE, {"turn": {"point": point, "axis": axis, "angle": 90}})


def test_degrees_are_the_same_motion_as_radians() -> None:
    by_degrees = Motion.turn([1, 0, 0], [0, 0, 1], degrees=90)
    assert by_degrees == Motion.turn([1, 0, 0], [0, 0, 1], radians=math.pi / 2)
    pose = [3, 0, 0]
    tables = [
        {"turn": {"point": [0, 0, 0], "axis": [0, 0, 1], unit: angle}}
        for unit, angle in (("degrees", [90.0, 45.0]), ("radians", np.radians([90.0, 45.0])))
    ]
    first, second = (motion_many(CUBE, CUBE, table, moving_pose=pose) for table in tables)
    assert first.outcome.tolist() == second.outcome.tolist()
    assert np.array_equal(first.lower, second.lower, equal_nan=True)


@pytest.mark.parametrize(
    "motion",
    [
        Motion.still([1, 2, 3]),
        Motion.slide([0, 0, 4]),
        Motion.slide([0, 0, 4], pose=[1, 2, 3, 0, 0, 1, 0]),
        Motion.turn([1, 0, 0], [0, 0, 1], degrees=90),
        Motion.screw([1, 0, 0], [0, 0, 1], degrees=720, rise=2, pose=[1, 0, 5]),
        Motion.thrown([0, 0, 0], [1, 2, 3], [0, 0, 2]),
    ],
)
def test_the_repr_of_a_motion_makes_it_again(motion: Motion) -> None:
    again = eval(repr(motion), {"Motion": Motion})
    for time in (0.0, 0.5, 1.0):
        assert np.allclose(again.at(time).as_matrix(), motion.at(time).as_matrix(), atol=1e-12)
    assert "radians=1.57" in repr(Motion.turn([1, 0, 0], [0, 0, 1], degrees=90))


def test_rotations_of_few_digits_are_normalised_with_a_warning() -> None:
    with pytest.warns(RoundedPoseWarning, match="off one by 1.5e-4"):
        pose = Pose([0, 0, 0, 0, 0, 0.707, 0.707])
    assert np.allclose(pose.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    c, s = round(math.cos(0.3), 6), round(math.sin(0.3), 6)
    matrix = np.array([[c, -s, 0, 1], [s, c, 0, 2], [0, 0, 1, 3.0]])
    matrix[:, :3] *= 1 + 1e-6
    with pytest.warns(RoundedPoseWarning):
        pose = Pose(matrix)
    assert np.abs(pose.rotation @ pose.rotation.T - np.eye(3)).max() < 1e-15
    with pytest.raises(PoseError):
        Pose([0, 0, 0, 0, 0, 0.8, 0.7])
    with pytest.raises(PoseError):
        Pose(np.diag([1, 1, -1, 1.0]))


def test_rotations_of_few_digits_in_bulk_are_normalised_with_one_warning() -> None:
    rows = [[0.5, 0, 9, 0, 0, 0.707, 0.707], [0.5, 0.5, 9, 0, 0, 0, 1], [0, 0, 9, 0, 0, 0.8, 0.7]]
    with pytest.warns(RoundedPoseWarning, match="1 of 3 rotations") as warned:
        columns = cast_many(CUBE, CUBE, [0, 0, -1], moving_pose=rows)
    assert len(warned) == 1
    assert columns.outcome.tolist() == ["contact", "contact", "error"]


def test_a_body_of_another_kind_is_refused_with_the_call_that_takes_it() -> None:
    solid: Any = Solid.from_pieces([CUBE])
    ask: Any = cast
    assert ask(solid, CUBE, [0, 0, -1], moving_pose=[0, 0, 3]).translation == 2
    convex_only: list[Any] = [contact_range, directional_depth, Cast, Tracker().cast]
    for question in convex_only:
        with pytest.raises(TypeError, match=r"Solid is not a ConvexPolyhedron; SolidCast\(.*cast"):
            question(solid, CUBE, [0, 0, 1])
    with pytest.raises(TypeError, match=r"ConvexPolyhedron\(points\) makes the convex hull"):
        ask(CUBE, np.zeros((4, 3)), [0, 0, 1])
    with pytest.raises(TypeError, match=r"ConvexPolyhedron\(points\) makes the convex hull"):
        clearance(CUBE, [[0, 0, 0]], [0, 0, 1])  # type: ignore[call-overload]


def test_a_list_of_poses_is_refused_for_one_question_and_taken_in_bulk() -> None:
    poses: Any = [Pose([0, 0, 3]), Pose([0, 0, 5])]
    with pytest.raises(InputError, match="a list of 2 poses, where one is expected"):
        cast(CUBE, CUBE, [0, 0, -1], moving_pose=poses)
    columns = cast_many(CUBE, CUBE, [0, 0, -1], moving_pose=poses)
    assert columns.translation.round(9).tolist() == [2.0, 4.0]


def test_a_mesh_that_is_not_closed_is_refused_by_both_constructors() -> None:
    mesh: Any = SimpleNamespace(vertices=np.eye(3), faces=np.array([[0, 1, 2]]))
    with pytest.raises(BuildError, match="the surface is open"):
        ConvexPolyhedron(mesh)
    with pytest.raises(BuildError, match="not closed"):
        Solid(mesh)
    with pytest.raises(InputError, match="faces: they are missing"):
        Solid(np.eye(3))


def test_sections_are_built_ahead_of_the_first_cast() -> None:
    ball = np.random.default_rng(1).standard_normal((400, 3))
    body = ConvexPolyhedron(ball / np.linalg.norm(ball, axis=1)[:, None])
    before = body.nbytes
    body.prepare()
    prepared = body.nbytes
    assert prepared > before
    cast(body, CUBE, [0, 0, 1], solver="cta")
    assert body.nbytes == prepared


def test_a_missing_file_is_a_file_not_found_error(tmp_path: Path) -> None:
    for read in (colltrans.read, Solid.read):
        with pytest.raises(FileNotFoundError, match=r"missing.stl: cannot be read") as missing:
            read(tmp_path / "missing.stl")
        assert missing.value.errno == errno.ENOENT
        assert str(pickle.loads(pickle.dumps(missing.value))) == str(missing.value)
        with pytest.raises(colltrans.errors.MeshError):
            read(tmp_path / "missing.stl")
    for name in ("missing.toml", "missing.glb", "missing.urdf", "missing.step", "missing"):
        with pytest.raises(FileNotFoundError, match=name):
            Assembly.read(tmp_path / name)
    robot = tmp_path / "arm.urdf"
    with pytest.raises(FileNotFoundError, match=r"arm.urdf"):
        Robot.read(robot)
    box = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    robot.write_text(f'<robot name="a"><link name="a">{box}</link></robot>')
    with pytest.raises(FileNotFoundError, match=r"missing.srdf"):
        Robot.read(robot, srdf=tmp_path / "missing.srdf")


def test_a_file_that_is_not_convex_names_the_calls_that_take_it(tmp_path: Path) -> None:
    part = tmp_path / "l.off"
    part.write_text(L_OFF)
    with pytest.raises(BuildError, match=r"Solid.read\(path\) .*read\(path, hull=True\)"):
        colltrans.read(part)
    assert Solid.read(part).volume == 3.0
    assert colltrans.read(part, hull=True).volume == 3.5
