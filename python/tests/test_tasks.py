"""Five tasks of newcomers, each in two to four statements (``docs/peers.md`` has the table)."""

import ast
import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

from colltrans import ConvexPolyhedron, Motion, Solid, cast, clearance, clearance_many, distance
from colltrans import motion as first_contact

PLACES = np.array([[0, 0, 3.0], [1, 2, 4], [9, 0, 3]])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def cast_of_a_turned_box() -> Any:
    parcel = ConvexPolyhedron.cuboid([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
    floor = ConvexPolyhedron.cuboid([-50, -50, -1], [50, 50, 1])
    return cast(parcel.at(((0, 0, 10), (0.6, 0, 0, 0.8))), floor, [0, 0, -1]).value


def distance_of_a_ball() -> Any:
    ball, tetrahedron = ConvexPolyhedron.sphere(0.5), ConvexPolyhedron(CORNERS)
    return distance(ball, tetrahedron.at([3, 4, 0])).value


def clearance_of_many_poses() -> Any:
    part = ConvexPolyhedron.cuboid([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
    table = ConvexPolyhedron.cuboid([-5, -5, -1], [5, 5, 1])
    return clearance_many(part, table, [0, 0, -1], moving_pose=PLACES).value


def clearance_of_meshes() -> Any:
    bolt, wedge = Solid.read(ROOT / "data/bolt.stl"), Solid(CORNERS, FACES)
    return clearance(bolt.at([0, 0, 7]), wedge, [0, 0, -1]).value


def contact_of_a_turning_door() -> Any:
    door = ConvexPolyhedron.cuboid([0, -0.02, 0], [1, 0.02, 2])
    post = ConvexPolyhedron.cuboid([0.55, 0.55, 0], [0.65, 0.65, 2])
    return first_contact(door, post, Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)).value


TASKS: list[tuple[Callable[[], Any], Any]] = [
    (cast_of_a_turned_box, 9 - 0.5 * (0.96 + 0.28)),
    (distance_of_a_ball, 4.5),
    (clearance_of_many_poses, [1.5, 2.5, np.inf]),
    (clearance_of_meshes, None),
    (contact_of_a_turning_door, 0.432115832),
]


@pytest.mark.parametrize(("task", "expected"), TASKS, ids=lambda of: getattr(of, "__name__", ""))
def test_a_task_takes_two_to_four_statements(task: Callable[[], Any], expected: Any) -> None:
    (function,) = ast.parse(inspect.getsource(task)).body
    statements = sum(isinstance(node, ast.stmt) for node in ast.walk(function)) - 1
    assert 2 <= statements <= 4
    found = task()
    assert np.isfinite(found).any()
    if expected is not None:
        assert np.allclose(found, expected, atol=1e-8)
