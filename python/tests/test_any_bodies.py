"""Tests solids and convex bodies in the same calls, single and in bulk; signals in long queries."""

import os
import signal
import subprocess
import sys
import time
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

from colltrans import (
    Cast,
    ConvexPolyhedron,
    InputError,
    Intersection,
    Solid,
    SolidBlocked,
    SolidCast,
    cast,
    cast_many,
    clearance,
    clearance_many,
    contact_range_many,
    intersects,
)
from colltrans.columns import Failed, SolidColumns
from colltrans.errors import BuildError, QueryError

DOWN = [0.0, 0, -1]
CUBE = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
PLATE = Solid.read(ROOT / "data/plate.off")
BOLT = Solid.read(ROOT / "data/bolt.stl")


def test_convex_bodies_and_solids_share_each_call() -> None:
    assert clearance(CUBE, CUBE, DOWN, moving_pose=[0, 0, 3]).distance == pytest.approx(2)
    pairs: list[tuple[Any, Any]] = [(BOLT, PLATE), (CUBE, PLATE), (BOLT, CUBE)]
    for moving, fixed in pairs:
        known = SolidCast(moving, fixed, DOWN, moving_pose=[1.3, 0.2, 7], tolerance=1e-6)
        answer: Any = clearance(moving, fixed, DOWN, moving_pose=[1.3, 0.2, 7], tolerance=1e-6)
        assert repr(answer) == repr(known.clearance())
        assert answer.query.tolerance == 1e-6
        assert intersects(moving, fixed, moving_pose=[1.3, 0.2, 7]) is known.intersects()
    assert isinstance(intersects(CUBE, CUBE), Intersection)
    within: Any = clearance(BOLT, PLATE, DOWN, moving_pose=[3, 0, 0], ignore_start_overlaps=True)
    assert type(within).__name__ != "SolidOverlapping"


def test_options_of_the_other_kind_of_body_are_refused() -> None:
    with pytest.raises(QueryError, match="tolerance and ignore_start_overlaps are for solids"):
        clearance(CUBE, CUBE, DOWN, tolerance=1e-6)
    with pytest.raises(QueryError, match="graze_tolerance and solver are for convex bodies"):
        cast(CUBE, PLATE, DOWN, graze_tolerance=1e-6)
    with pytest.raises(QueryError, match="unknown solver"):
        clearance(CUBE, PLATE, DOWN, solver="newton")  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="fixed: neither a ConvexPolyhedron nor a Solid, but str"):
        clearance(CUBE, "cube", DOWN)  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="Solid is not a ConvexPolyhedron"):
        Cast(CUBE, PLATE, DOWN)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="contact ranges of solids are not answered"):
        contact_range_many(CUBE, [PLATE], DOWN)  # type: ignore[list-item]
    with pytest.raises(InputError, match="are for solids"):
        cast_many(CUBE, CUBE, DOWN, tolerance=1e-3)
    with pytest.raises(InputError, match="graze_tolerance, solver: are for convex bodies"):
        clearance_many(CUBE, PLATE, DOWN, graze_tolerance=1e-3)  # type: ignore[call-overload]
    with pytest.raises(InputError, match="are for solids"):
        clearance_many(CUBE, CUBE, DOWN, tolerance=1e-3)


def poses(n: int) -> Any:
    random = np.random.default_rng(2)
    turns = random.normal(size=(n, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return np.hstack([random.uniform(-4, 4, size=(n, 3)) + [0, 0, 6], turns])


def test_columns_of_solids_equal_single_answers() -> None:
    n = 60
    starts, index = poses(n), np.arange(n) % 2
    tolerances = np.where(np.arange(n) % 3 == 0, 1e-6, 1e-3)
    arguments: Any = {"moving_pose": starts, "moving_index": index, "tolerance": tolerances}
    columns = clearance_many([BOLT, CUBE], PLATE, DOWN, **arguments, threads=2)
    assert isinstance(columns, SolidColumns) and set(columns.counts()) == set(columns.outcomes[:3])
    for i in range(n):
        tolerance = float(tolerances[i])
        body: Any = (BOLT, CUBE)[i % 2]
        one: Any = clearance(body, PLATE, DOWN, moving_pose=starts[i], tolerance=tolerance)
        assert repr(columns[i]) == repr(one)
        distance = np.nan if one.distance is None else one.distance
        assert np.array_equal(columns.distance[i], distance, equal_nan=True)
        if isinstance(one, SolidBlocked):
            assert columns.normal[i].tobytes() == one.contact.normal.tobytes()
            assert columns.translation[i] == one.contact.translation
            bounds = (columns.translation_lower[i], columns.translation_upper[i])
            assert bounds == one.contact.translation_bounds
    alone = clearance_many([BOLT, CUBE], PLATE, DOWN, **arguments, threads=1)
    assert alone.distance.tobytes() == columns.distance.tobytes()
    assert alone.point.tobytes() == columns.point.tobytes()
    assert "blocked" in columns._repr_html_()
    pytest.importorskip("pyarrow")
    assert columns.to_arrow().column_names[:2] == ["outcome", "distance"]


def test_invalid_rows_of_solids_become_errors() -> None:
    starts = poses(8)
    starts[1, 0], starts[2, 3:] = np.nan, 7
    directions = np.tile(DOWN, (8, 1))
    directions[3] = 0
    bodies: Any = [BOLT, BuildError("it was bent"), ConvexPolyhedron([[0, 0, 0], [1, 0, 0]])]
    index = [0, 0, 0, 0, 1, -1, 9, 2]
    asked: dict[str, Any] = {"moving_pose": starts, "moving_index": index}
    columns = clearance_many(bodies, PLATE, directions, **asked)
    gaps = [np.nan, *[0.0] * 7]
    assert 0 in clearance_many(bodies, PLATE, directions, **asked, min_gap=gaps).errors
    assert sorted(columns.errors) == [1, 2, 3, 4, 5, 6]
    assert columns.errors[4] == "moving: it was bent"
    assert columns.errors[5] == "moving: no body -1 among 3"
    assert columns[3] == Failed(columns.errors[3]) and "direction" in columns.errors[3]
    assert columns.counts()["error"] == 6 and np.isnan(columns.distance[1:7]).all()
    assert len(clearance_many(BOLT, PLATE, np.zeros((0, 3)))) == 0


LONG = """
import numpy as np, colltrans, sys
n = int(sys.argv[1])
u, v = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
a, b = 2 * np.pi * u.ravel() / n, 2 * np.pi * v.ravel() / n
r = 3 + np.cos(b) + 0.01 * np.sin(7 * a + 5 * b)
points = np.column_stack([r * np.cos(a), r * np.sin(a), np.sin(b)])
at = lambda i, j: (i % n) * n + j % n
faces = np.stack([at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)], -1).reshape(-1, 4)
body = colltrans.Solid(points, np.vstack([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]))
near = [0.001, 0, 2.2, 0.01, 0.02, 0.03, (1 - 0.0014) ** 0.5]
print("ready", flush=True)
try:
    while True:
        QUERY
except KeyboardInterrupt:
    print("interrupted", flush=True)
import os
os._exit(0)
"""
QUERIES = {
    "one": "colltrans.SolidCast(body, body, [0, 0, -1], moving_pose=near).certified_clearance()",
    "many": "colltrans.clearance_many(body, body, [[0, 0, -1]] * 1000, moving_pose=near)",
}


@pytest.mark.skipif(os.name == "nt", reason="signals are sent another way")
@pytest.mark.parametrize("query", QUERIES)
def test_a_signal_interrupts_queries_of_large_solids(query: str) -> None:
    program = LONG.replace("QUERY", QUERIES[query])
    command = [sys.executable, "-c", program, "150"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.perf_counter()
        process.send_signal(signal.SIGINT)
        try:
            told, _ = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        assert told == "interrupted\n"
        # Takes a second on an idle machine.
        assert time.perf_counter() - sent < 5
