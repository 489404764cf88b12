"""Tests the minimum gap: the command line, single and bulk queries, obstacles, refusals."""

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Batch, draw

from colltrans import (
    Cast,
    ConvexPolyhedron,
    Obstacles,
    Solid,
    SolidBlocked,
    SolidCast,
    Tracker,
    cast,
    cast_many,
    check,
    clearance,
    clearance_many,
    contact_range,
    contact_range_many,
    intersects,
    within,
)
from colltrans.errors import QueryError

CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
ABOVE = [0.0, 0, 4]
DOWN = [0.0, 0, -1]


def test_a_cast_with_a_gap_stops_at_the_gap() -> None:
    query = Cast(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=0.25)
    assert query.min_gap == 0.25
    found: Any = query.cast()
    assert found.certificate.lower <= 2.75 <= found.certificate.upper
    assert found.certificate.verify() < 1e-12
    assert found.to_dict()["min_gap"] == 0.25
    both: Any = contact_range(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=0.25)
    assert both.interval == (2.75, 5.25)
    assert bool(Cast(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=3.5).intersects())
    tracked: Any = Tracker().clearance(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=0.25)
    assert tracked.distance == pytest.approx(2.75)
    assert clearance(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=3.5).distance is None
    for again in (copy.copy(query), pickle.loads(pickle.dumps(query))):
        assert again.min_gap == 0.25
        same: Any = again.cast()
        assert same.translation == 2.75
    for answer in (found, both, clearance(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=3.5)):
        text = answer.proof_json()
        report = check.check(text)
        assert report.holds and not report.partly
        gap = f'"min_gap":{answer.query.min_gap!r}'
        for other in (answer.query.min_gap - 1e-9, answer.query.min_gap + 1e-9):
            with pytest.raises(check.RefusedError):
                check.check(text.replace(gap, f'"min_gap":{other!r}'))
    with pytest.raises(check.NoProofError, match="out of range"):
        check.check(found.proof_json().replace('"min_gap":0.25', '"min_gap":-0.25'))


def test_solids_stop_at_the_gap() -> None:
    plate = Solid.read(ROOT / "data/plate.off")
    far: Any = clearance
    meets: Any = intersects
    pairs: list[tuple[Any, Any]] = [(CUBE, plate), (Solid.from_pieces([CUBE]), CUBE)]
    for moving, fixed in pairs:
        touching = far(moving, fixed, DOWN, moving_pose=[5, 0, 9], tolerance=0)
        kept = far(moving, fixed, DOWN, moving_pose=[5, 0, 9], tolerance=0, min_gap=0.5)
        if isinstance(touching, SolidBlocked):
            assert kept.distance == pytest.approx(touching.distance - 0.5, abs=1e-10)
        query = SolidCast(moving, fixed, DOWN, moving_pose=[5, 0, 9], tolerance=0, min_gap=0.5)
        again = pickle.loads(pickle.dumps(query))
        assert (query.min_gap, again.min_gap) == (0.5, 0.5)
        answer, proof = again.certified_clearance()
        assert repr(answer) == repr(kept)
        query.verify(proof)
        with pytest.raises(TypeError, match="min_gap"):
            meets(moving, fixed, min_gap=0.5)
    # A quarter of a unit apart: they do not meet, but are closer than the gap.
    apart: dict[str, Any] = {"moving_pose": [0, 0, 1.25]}
    block = Solid.from_pieces([CUBE])
    assert not meets(block, CUBE, **apart)
    for length, closer in ((0.5, True), (0.125, False)):
        assert within(block, CUBE, length, **apart).closer is closer
        query = SolidCast(block, CUBE, DOWN, **apart, tolerance=0, min_gap=length)
        assert query.intersects() is closer


@pytest.mark.parametrize("gap", [-1.0, math.nan, math.inf, 1e70])
def test_invalid_gaps_are_refused(gap: float) -> None:
    solid = Solid.from_pieces([CUBE])
    obstacles = Obstacles()
    obstacles.add(CUBE)
    for moving in (CUBE, solid):
        far: Any = clearance
        with pytest.raises(QueryError, match="gap"):
            far(moving, CUBE, DOWN, min_gap=gap)
    with pytest.raises(QueryError, match="gap"):
        cast(CUBE, CUBE, DOWN, min_gap=gap)
    with pytest.raises(QueryError, match="gap"):
        SolidCast(solid, CUBE, DOWN, min_gap=gap)
    with pytest.raises(QueryError, match="gap"):
        obstacles.clearance(CUBE, DOWN, min_gap=gap)
    columns = cast_many(CUBE, CUBE, DOWN, moving_pose=ABOVE, min_gap=[gap, 0.0])
    assert (list(columns.errors), columns.translation[1]) == ([0], 3)
    assert "gap" in columns.errors[0]


def test_rows_with_gaps_equal_single_answers_and_the_command_line(batch: Batch) -> None:
    settings = draw(17, 300)
    bodies = settings.bodies()
    sides: Any = (bodies, bodies, settings.direction)
    where: dict[str, Any] = {
        "moving_pose": settings.moving_pose,
        "fixed_pose": settings.fixed_pose,
        "moving_index": settings.moving,
        "fixed_index": settings.fixed,
    }
    told = batch(settings.lines(query="clearance", min_gap=0.125))
    columns = clearance_many(*sides, **where, min_gap=0.125)
    spans = contact_range_many(*sides, **where, min_gap=np.full(len(settings), 0.125))
    for i, line in enumerate(told):
        answer: Any = columns[i]
        assert columns.outcome[i] == line["outcome"]
        if line["outcome"] == "blocked":
            assert columns.distance[i] == line["distance"]
            assert answer.to_dict()["translation_bounds"] == line["translation_bounds"]
            assert answer.query.min_gap == 0.125
            assert spans.translation[i] == line["translation"]
        report = check.check(answer.proof_json())
        assert report.holds and not report.partly
    assert columns.counts()["blocked"] > 10


def test_scene_queries_stop_at_the_gap() -> None:
    obstacles = Obstacles()
    obstacles.add_many(CUBE, [[2 * k, 0, 0] for k in range(50)])
    obstacles.add(Solid.from_pieces([CUBE]), [200, 0, 0])
    for x in (24.25, 200.25):
        found = obstacles.clearance(CUBE, DOWN, [x, 0, 4], min_gap=0.5)
        assert found.distance == pytest.approx(2.5, abs=1e-10)
    # Between two of them, half a unit from each.
    aside = [25.0 - 0.2, 1.4, 4]
    assert obstacles.clearance(CUBE, DOWN, aside).outcome == "free"
    assert obstacles.clearance(CUBE, DOWN, aside, min_gap=0.5).outcome == "blocked"
    many = obstacles.clearance_many(CUBE, DOWN, [[24.25, 0, 4], aside], min_gap=0.5)
    assert many["outcome"].tolist() == ["blocked", "blocked"]
    alone = obstacles.clearance(CUBE, DOWN, aside, min_gap=0.5)
    assert many["distance"][1] == alone.distance
