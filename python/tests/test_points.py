"""Tests points and segments against parts: all questions answer, or refuse a body without area."""

from typing import Any

import numpy as np
import pytest

import colltrans
from colltrans import (
    ConvexPolyhedron,
    Motion,
    Obstacles,
    Solid,
    SolidBlocked,
    SolidFree,
    check,
    clearance,
    clearance_many,
    distance,
    motion_many,
    within,
)
from colltrans.errors import BuildError
from colltrans.motions import motion_clearance

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
FAR = ConvexPolyhedron.cuboid([7, 7, 7], [8, 8, 8])
PART = Solid.from_pieces([CUBE, FAR])
POINT = ConvexPolyhedron([[3, 0.5, 0.5]])
SEGMENT = ConvexPolyhedron([[4, 0.75, 0.5], [3, 0.5, 0.25]])


@pytest.mark.parametrize("body", [POINT, SEGMENT])
def test_a_point_stops_at_a_face_and_its_proof_holds(body: ConvexPolyhedron) -> None:
    stopped: Any = clearance(body, PART, [-1, 0, 0])
    assert 2 - 1e-11 < stopped.distance <= 2
    stops = check.check(stopped.proof_json()).holds
    assert any("first meet at 2" in line or "first meet at 1.99999" in line for line in stops)
    apart = distance(body, PART)
    assert apart.lower <= 2 <= apart.upper < apart.lower + 1e-11
    assert check.check(apart.proof_json()).holds
    assert within(body, PART, 2.1).closer and not within(body, PART, 1.9).closer
    rows = clearance_many(body, PART, np.array([[-1.0, 0, 0], [1, 0, 0]]))
    assert not rows.errors and rows.distance[0] == stopped.distance


def test_scenes_take_points_either_way() -> None:
    parts, points = Obstacles(), Obstacles()
    parts.add(PART)
    points.add(POINT)
    for nearest in (parts.nearest(POINT), points.nearest(PART)):
        assert nearest is not None and nearest.lower <= 2 <= nearest.upper
    stop: Any = parts.clearance(POINT, [-1, 0, 0])
    assert 2 - 1e-11 < stop.distance <= 2


@pytest.mark.parametrize("body", [POINT, SEGMENT])
def test_motions_bound_the_contact_from_above(body: ConvexPolyhedron) -> None:
    turn = Motion.turn([1.5, 0, 0], [0, 0, 1], degrees=180)
    found: Any = colltrans.motion(body, PART, turn)
    assert found.outcome == "contact" and found.upper - found.lower < 1e-11
    report = check.check(found.proof_json())
    assert [line for line in report.holds if "meet at the time" in line]
    stopped: Any = motion_clearance(body, PART, turn)
    assert stopped.time <= found.lower < stopped.time + 1e-9
    rows = motion_many(body, PART, [turn, turn])
    assert not rows.errors and rows.upper.tolist() == [found.upper] * 2


def test_a_point_passes_where_two_pits_meet_in_a_vertex() -> None:
    # A block of 8 with a pit from above and one from below, whose tips are one vertex.
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    rims = [[[low + s * size, low + t * size] for s, t in square] for low, size in [(0, 8), (2, 4)]]
    layers = [(0, 0), (1, 0), (1, 8), (0, 8)]
    points = [[x, y, z] for rim, z in layers for x, y in rims[rim]] + [[4, 4, 4]]
    facets = []
    for k in range(4):
        n = (k + 1) % 4
        facets += [[k, n, 12 + n, 12 + k], [12 + k, 12 + n, 8 + n, 8 + k], [8 + k, 8 + n, 16]]
        facets += [[k, 4 + k, 4 + n, n], [4 + k, 16, 4 + n]]
    block = Solid(points, facets)
    rod = ConvexPolyhedron([[4, 4, 9], [4, 4, -1]])
    assert isinstance(clearance(ConvexPolyhedron([[4, 4, 9]]), block, [0, 0, -1]), SolidFree)
    assert isinstance(clearance(ConvexPolyhedron([[4, 3, 9]]), block, [0, 0, -1]), SolidBlocked)
    assert isinstance(clearance(rod, block, [1, 0, 0]), SolidBlocked)


def test_a_union_of_points_is_refused_with_the_way_out() -> None:
    with pytest.raises(BuildError, match="a segment has no area.*a small box"):
        Solid.from_pieces([SEGMENT])
