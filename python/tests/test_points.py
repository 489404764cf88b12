"""Points and segments against parts: every question answers, and what needs an area says so."""

from typing import Any

import numpy as np
import pytest

from colltrans import (
    BuildError,
    ConvexPolyhedron,
    Obstacles,
    Solid,
    check,
    clearance,
    clearance_many,
    distance,
    within,
)

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
FAR = ConvexPolyhedron.cuboid([7, 7, 7], [8, 8, 8])
PART = Solid.from_pieces([CUBE, FAR])
POINT = ConvexPolyhedron([[3, 0.5, 0.5]])
SEGMENT = ConvexPolyhedron([[4, 0.75, 0.5], [3, 0.5, 0.25]])


@pytest.mark.parametrize("body", [POINT, SEGMENT])
def test_the_tip_stops_at_the_face_and_proofs_hold(body: ConvexPolyhedron) -> None:
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


def test_a_union_of_points_is_refused_with_the_way_out() -> None:
    with pytest.raises(BuildError, match="a segment has no area.*a small box"):
        Solid.from_pieces([SEGMENT])
